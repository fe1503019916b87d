// SPDX-License-Identifier: MIT
#include "cli/analyze/analyze_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/say.hpp"
#include "core/words.hpp"
#include "options/option.hpp"
#include "study/analysis/analysis.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

constexpr int usual_decimals = 2;

std::string value_text(std::optional<double> v, int decimals = usual_decimals)
{
    return v ? fmt::format("{:.{}f}", *v, decimals) : "-";
}

std::string p_text(std::optional<double> p)
{
    return !p ? "-" : *p < 0.001 ? "<.001" : fmt::format("{:.3f}", *p);
}

std::string p_clause(std::optional<double> p)
{
    return !p ? "p -" : *p < 0.001 ? "p < 0.001" : fmt::format("p = {:.3f}", *p);
}

std::string interval_text(const std::optional<study::interval>& i, int decimals = usual_decimals)
{
    return i ? fmt::format("{:.{}f} ... {:.{}f}", i->first, decimals, i->second, decimals) : "-";
}

std::string interval_text(const std::optional<study::interval>& i, const study::interval& possible)
{
    return i ? interval_text(study::clamp_interval(*i, possible)) : "-";
}

// Returns mean, standard error and 95 % interval as columns of text.
std::string mean_text(const study::t_test& t, int decimals)
{
    return fmt::format("{:>8} (se {}), 95 % {}", value_text(t.mean, decimals), value_text(t.se, decimals),
                       interval_text(t.ci, decimals));
}

// Precondition: the test has a t value.
std::string t_text(const study::t_test& t)
{
    return fmt::format("t({:.0f}) = {:.2f}, {}", *t.df, *t.t, p_clause(t.p));
}

// Precondition: the effect has an F value.
std::string effect_text(const study::effect& e)
{
    std::string text =
        fmt::format("F({:.0f}, {:.0f}) = {:.2f}, {}; eta squared partial {:.3f}, generalised {:.3f}", e.df1,
                    e.df2, *e.f, p_clause(e.p), *e.eta2_partial, *e.eta2_generalised);
    if (e.epsilon_gg)
        text += fmt::format("; Greenhouse-Geisser {:.3f}, {}", *e.epsilon_gg, p_clause(e.p_gg));
    if (e.epsilon_hf)
        text += fmt::format("; Huynh-Feldt {:.3f}, {}", *e.epsilon_hf, p_clause(e.p_hf));
    if (e.mauchly_w)
        text += fmt::format("; Mauchly W = {:.3f}, {}", *e.mauchly_w, p_clause(e.mauchly_p));
    return text;
}

std::size_t widest(const std::vector<std::string>& names)
{
    std::size_t w = 5;
    for (const std::string& n : names)
        w = std::max(w, std::min<std::size_t>(n.size(), 16));
    return w;
}

// Returns the number of decimals for a figure in the unit of a run's values. It is the number of decimals in
// a hundredth of their range, but at least two.
int count_decimals(const study::run_outline& run)
{
    if (run.values.empty())
        return usual_decimals;
    const double range = run.values.back() - run.values.front();
    return std::max(usual_decimals, usual_decimals - static_cast<int>(std::floor(std::log10(range))));
}

std::string figure_name(const study::measured_figure& f)
{
    return f.name == "dprime" ? "d'" : f.name;
}

std::string ratio_text(const study::difference_test& d)
{
    return fmt::format("likelihood ratio {:.2f}, {}", d.likelihood_ratio, p_clause(d.p));
}

std::string test_text(const study::measured_figure& f, const std::optional<study::difference_test>& ratio)
{
    return ratio ? ratio_text(*ratio) : f.test.t && f.against ? t_text(f.test) : "";
}

std::string difference_text(const study::t_test& t, int decimals = usual_decimals, const char* d = "d_z")
{
    std::string text = value_text(t.mean, decimals);
    if (t.t)
        text += fmt::format(" ({}), {}", interval_text(t.ci, decimals), t_text(t));
    if (t.p_signflip)
        text += fmt::format(", signs {}", p_text(t.p_signflip));
    if (t.d)
        text += fmt::format("; {} = {:.2f} ({})", d, *t.d, interval_text(t.d_ci));
    return text;
}

void print_pairs(const std::vector<study::paired_comparison>& pairs, const std::vector<std::string>& names,
                 const char* d, int decimals)
{
    for (const study::paired_comparison& c : pairs)
        say(stdout, "{}",
            wrap_text(fmt::format("    {} - {}: ", names[c.a], names[c.b]),
                      difference_text(c.test, decimals, d) +
                          (pairs.size() > 1 ? ", Holm " + p_text(c.p_holm) : "")));
}

// Returns the decimals of a result: those of the run's values if its figures have their unit.
template <class T>
int find_decimals(const T&, const study::run_outline& run)
{
    constexpr bool own_unit =
        std::is_same_v<T, study::exponents> || std::is_same_v<T, study::drawn_answers> || requires(const T& v)
    {
        v.ratio;
    };
    return own_unit ? usual_decimals : count_decimals(run);
}

// Formatter of a run's main figure as one line: "NAME MEAN UNIT (INTERVAL) against VALUE, P".
class summary {
public:
    explicit summary(const study::run_outline& run) : run_(run) {}

    std::string operator()(const study::cell_means& v) const
    {
        const study::t_test& t = v.means.front().test;
        return join((v.method.empty() ? "" : v.method + " ") + v.axis, t,
                    t.ci ? std::optional(study::clamp_interval(*t.ci, v.possible)) : std::nullopt,
                    usual_decimals, "", v.against, v.against && t.t ? p_clause(t.p) : "");
    }
    std::string operator()(const study::method_difference& v) const
    {
        return join(fmt::format("{} - {}", v.last, v.first), v.test, v.test.ci, usual_decimals, "", {},
                    v.test.t ? p_clause(v.test.p) : "");
    }
    template <class T>
    std::string operator()(const T& v) const
    {
        if constexpr (requires { v.ratio; })
            return join(v.figures.front(), usual_decimals, v.ratio);
        else if constexpr (requires { v.figures; })
            return join(v.figures.front(), find_decimals(v, run_));
        else
            return {}; // such a result is never the main one
    }

private:
    static std::string join(const std::string& name, const study::t_test& t,
                            const std::optional<study::interval>& ci, int decimals, const std::string& unit,
                            std::optional<double> against, const std::string& test)
    {
        return fmt::format("{} {}{}{}{}{}{}", name, value_text(t.mean, decimals),
                           unit.empty() || !t.mean ? "" : " " + unit,
                           ci ? fmt::format(" ({})", interval_text(ci, decimals)) : "",
                           against && !test.empty() ? fmt::format(" against {}", *against) : "",
                           test.empty() ? "" : ", ", test);
    }
    std::string join(const study::measured_figure& f, int decimals,
                     const std::optional<study::difference_test>& ratio = {}) const
    {
        return join(figure_name(f), f.test, f.test.ci, decimals, find_figure_unit(run_, f.name), f.against,
                    ratio                   ? ratio_text(*ratio)
                    : f.test.t && f.against ? p_clause(f.test.p)
                                            : "");
    }

    const study::run_outline& run_;
};

constexpr const char* column_legend =
    "mean and se (standard error) are over participants; 95 % is the interval of the mean, cut to what is "
    "possible; t and p compare the mean with what guessing gives (two-sided); Holm is p adjusted for the "
    "number of motions; signs is the exact p of all changes of sign; d is the effect size, (mean - guessing) "
    "/ sd.";

// Prints the table of a result below its heading.
class table_printer {
public:
    explicit table_printer(const study::run_outline& run) : run_(run) {}

    void operator()(const study::cell_means& v) const
    {
        std::vector<std::string> names;
        for (const study::cell_mean& m : v.means)
            names.push_back(m.name);
        const std::size_t w = widest(names);
        fmt::print("  {:<{}} {:>6} {:>5} {:>16}", "", w, "mean", "se", "95 %");
        if (v.against)
            fmt::print(" {:>6} {:>5} {:>5} {:>5}  {}", "t", "p", "Holm", "signs", "d");
        fmt::print("\n");
        for (const study::cell_mean& m : v.means) {
            const study::t_test& t = m.test;
            say(stdout, "  {:<{}} {:>6} {:>5} {:>16}", m.name, w, value_text(t.mean), value_text(t.se),
                interval_text(t.ci, v.possible));
            if (v.against)
                fmt::print(" {:>6} {:>5} {:>5} {:>5}  {}", value_text(t.t), p_text(t.p), p_text(m.p_holm),
                           p_text(t.p_signflip), value_text(t.d));
            fmt::print("\n");
        }
        if (const study::t_test& all = v.means.front().test; v.against && all.t)
            fmt::print("  all: {}; d = {:.2f} ({})\n", t_text(all), *all.d, interval_text(all.d_ci));
    }

    void operator()(const study::interval_share& v) const
    {
        fmt::print("  first interval chosen: {:.1f} %{}\n", *v.test.mean,
                   v.test.t ? ", " + t_text(v.test) : "");
    }

    void operator()(const study::method_difference& v) const
    {
        say(stdout, "{}", wrap_text(fmt::format("  {} - {}: ", v.last, v.first), difference_text(v.test)));
    }

    void operator()(const study::effect_list& v) const
    {
        for (const auto& [name, e] : v.effects)
            if (e && e->f)
                fmt::print("{}", wrap_text(fmt::format("    {}: ", name), effect_text(*e)));
    }

    void operator()(const study::tukey_list& v) const
    {
        const std::size_t w = widest(v.motions);
        for (const study::comparison& c : v.pairs)
            say(stdout, "    {:<{}} - {:<{}} {:>7} q = {:>5}, {}\n", v.motions[c.a], w, v.motions[c.b], w,
                value_text(c.difference), value_text(c.q), p_clause(c.p));
    }

    void operator()(const study::paired_list& v) const
    {
        const std::size_t w = widest(v.motions);
        for (const study::paired_comparison& c : v.pairs)
            say(stdout, "    {:<{}} - {:<{}} {:>7} t = {:>5}, {}, Holm {}\n", v.motions[c.a], w,
                v.motions[c.b], w, value_text(c.test.mean), value_text(c.test.t), p_clause(c.test.p),
                p_text(c.p_holm));
    }

    void operator()(const study::figure_comparison& v) const
    {
        const int decimals = count_decimals(run_);
        const std::size_t w = widest(v.levels);
        for (std::size_t i = 0; i < v.levels.size() && v.levels.size() > 1; ++i)
            say(stdout, "    {:<{}} {}\n", v.levels[i], w, mean_text(v.all.means[i], decimals));
        print_pairs(v.pairs, v.levels, "d_z", decimals);
        if (v.anova && v.anova->f)
            fmt::print("{}", wrap_text(fmt::format("    {}: ", v.factor), effect_text(*v.anova)));
        if (v.groups && has_table(*v.groups)) {
            fmt::print("    with the group as a factor between participants:\n");
            const std::size_t wide = widest(list_groups(v));
            for (const study::level_means& m : v.by_group)
                say(stdout, "    {:<{}} {}\n", m.group, wide, mean_text(m.overall, decimals));
            print_pairs(v.group_pairs, list_groups(v), "d", decimals);
            (*this)(*v.groups);
        }
    }

    void operator()(const study::worth_list& v) const
    {
        const std::size_t w = widest(v.methods);
        for (std::size_t m = 1; m < v.worths.size(); ++m)
            say(stdout, "    {:<{}} {:>6} ({})\n", v.methods[m], w, value_text(v.worths[m].log_worth),
                value_text(v.worths[m].se));
    }

    void operator()(const study::method_map& v) const
    {
        const std::size_t w = widest(v.methods);
        for (std::size_t m = 0; m < v.methods.size(); ++m) {
            const auto& [x, y] = v.all.scaled.places[m];
            say(stdout, "    {:<{}} {:>7.2f} {:>7.2f}\n", v.methods[m], w, x, y);
        }
        fmt::print("    stress {:.3f}\n", v.all.scaled.stress);
    }

    void operator()(const study::answer_counts& v) const
    {
        const std::size_t w = widest(v.motions);
        for (std::size_t i = 0; i < v.motions.size(); ++i)
            say(stdout, "    {:<{}} {:>5}\n", v.motions[i], w, fmt::join(v.counts[i], " "));
    }

    void operator()(const study::psychometric_functions& v) const
    {
        const int decimals = count_decimals(run_);
        print_figures(v, decimals);
        print_people(v, decimals, [&](const study::fitted_function& f) -> std::string {
            if (!f.bootstrap.p_gof)
                return {};
            return fmt::format("  {} {}  fit p {}", v.figures.front().name,
                               interval_text(f.bootstrap.threshold, decimals), p_text(f.bootstrap.p_gof));
        });
    }
    void operator()(const study::drawn_answers& v) const
    {
        print_figures(v, usual_decimals);
        print_people(v, usual_decimals, [](const auto&) { return std::string(); });
        for (const study::predicted_drawing& p : v.predicted)
            say(stdout, "    {} observer, from the mean drawing: distance {:.2f} mm{}\n", p.observer,
                p.distance_mm,
                v.kind == study::drawing_kind::path ? fmt::format(", Frechet {:.2f} mm", p.frechet_mm) : "");
    }
    template <class T>
    void operator()(const T& v) const
    {
        if constexpr (requires { v.ratio; })
            print_figures(v, usual_decimals, v.ratio);
        else if constexpr (requires { v.figures; })
            print_figures(v, find_decimals(v, run_));
        if constexpr (requires { v.figures; })
            print_people(v, find_decimals(v, run_), [](const auto&) { return std::string(); });
    }

private:
    template <class Person>
    void print_figures(const study::measured<Person>& v, int decimals,
                       std::optional<study::difference_test> ratio = {}) const
    {
        for (const study::measured_figure& f : v.figures) {
            const std::string name =
                f.against ? fmt::format("{} against {}", figure_name(f), *f.against) : figure_name(f);
            const std::string test = test_text(f, std::exchange(ratio, {}));
            say(stdout, "    {:<20} {}{}{}\n", name, mean_text(f.test, decimals), test.empty() ? "" : ", ",
                test);
        }
    }

    // Prints a line for each participant with the figures of all trials. `more` returns text after the
    // figures.
    template <class Person, class More>
    void print_people(const study::measured<Person>& v, int decimals, const More& more) const
    {
        if (!v.condition.empty())
            return;
        const std::size_t w = widest(v.codes);
        for (std::size_t i = 0; i < v.codes.size(); ++i) {
            std::string row;
            for (std::size_t k = 0; k < v.figures.size(); ++k)
                row += fmt::format("  {} {}", v.figures[k].name, value_text(v.values[i][k], decimals));
            say(stdout, "    sub-{:<{}}{}{}\n", v.codes[i], w, row, more(v.people[i]));
        }
    }

    const study::run_outline& run_;
};

// Prints the median response time. Also prints the conditions with the shortest and the longest times.
void print_times(const study::response_times& t)
{
    if (!t.median_s)
        return;
    std::string text = fmt::format("median {:.2f} s", *t.median_s);
    using condition = std::pair<std::string, std::optional<double>>;
    const auto [low, high] = std::ranges::minmax_element(t.by, {}, &condition::second);
    if (t.by.size() > 1 && low->second)
        text += fmt::format(", from {:.2f} s ({}) to {:.2f} s ({})", *low->second, low->first, *high->second,
                            high->first);
    say(stdout, "{}", wrap_text("  response time: ", text));
}

// Returns the results that Park et al. (2016) report for one of their runs, or "" for any other run.
std::string_view published_results(std::string_view experiment, std::string_view run)
{
    constexpr std::array<std::pair<std::string_view, std::string_view>, 4> figures{
        {{"similarity", "79.2 %, t(11) = 6.84, p < 0.001; motions F(3, 33) = 11.43, p < 0.001; motion 2 "
                        "differs from the others"},
         {"uniformity",
          "82.3 %, t(11) = 5.5, p < 0.001; motions F(3, 33) = 4.4, p = 0.01; motion 2 differs from 3 and 4"},
         {"similarity-rating", "2.65 and 3.89, t(11) = 13.23, p < 0.001; method F(1, 11) = 40.66, motion "
                               "F(3, 33) = 9.1, interaction F(3, 33) = 7.87, all p < 0.001 (13.23^2 is "
                               "175.0, not 40.66, which F of two methods would be)"},
         {"uniformity-rating", "2.51 and 3.74, t(11) = 8.06, p < 0.001; method F(1, 11) = 40.04, p < 0.001, "
                               "motion F(3, 33) = 6.51, p = 0.001, interaction F(3, 33) = 3.91, p = 0.02 "
                               "(8.06^2 is 65.0, not 40.04, which F of two methods would be)"}}};
    if (experiment == "park2016")
        for (const auto& [name, text] : figures)
            if (name == run)
                return text;
    return {};
}

void print_run(const study::analysis& a, const study::run_analysis& r)
{
    say(stdout, "\n{}: {}, {}, {}\n", r.run.name, find_run_task(r.run).name(), counted(r.n, "participant"),
        counted(r.trials, "trial"));
    if (r.dropped != 0)
        say(stdout, "  {} left out: {}\n", counted(r.dropped, "trial"), a.drop_rule);
    if (r.early != 0)
        fmt::print("  {} early (sooner after the stimulus than min_response_s), counted\n",
                   counted(r.early, "answer"));
    if (r.n == 0)
        return;
    if (!r.tracks.empty())
        for (const std::string& text : describe_tracks(r))
            say(stdout, "{}", wrap_text("  ", text));
    print_times(r.times);
    for (const study::result& row : r.results) {
        if (!has_table(row.value))
            continue;
        if (!row.heading.empty())
            say(stdout, "{}", wrap_text("  ", row.heading + ":"));
        std::visit(table_printer(r.run), row.value);
    }
    if (const std::string_view paper = published_results(a.experiment, r.run.name); !paper.empty())
        say(stdout, "{}", wrap_text("  Park et al. 2016: ", std::string(paper)));
}

// Returns, for each factor, the figures that are compared, each with the p value of its test: "jnd, p =
// 0.004".
std::vector<std::pair<std::string, std::vector<std::string>>>
list_factor_tests(const std::vector<study::result>& results)
{
    std::vector<std::pair<std::string, std::vector<std::string>>> all;
    const auto add = [&](const std::string& factor, const std::string& figure, std::optional<double> p) {
        auto at = std::ranges::find(all, factor, [](const auto& one) { return one.first; });
        if (at == all.end())
            at = all.insert(all.end(), {factor, {}});
        // Methods and sessions each have a test of groups, from other cells. Keeps that of methods.
        const auto is_same = [&](const std::string& text) { return text.starts_with(figure + ", "); };
        if (p && std::ranges::none_of(at->second, is_same))
            at->second.push_back(fmt::format("{}, {}", figure, p_clause(p)));
    };
    for (const study::figure_comparison* c : study::list_values<study::figure_comparison>(results)) {
        if (c->pairs.size() == 1)
            add(c->factor, c->figure, c->pairs.front().test.p);
        else if (c->anova)
            add(c->factor, c->figure, c->anova->p_gg ? c->anova->p_gg : c->anova->p);
        if (c->groups && c->groups->effects.front().second)
            add("group", c->figure, c->groups->effects.front().second->p);
    }
    std::erase_if(all, [](const auto& one) { return one.second.empty(); });
    return all;
}

} // namespace

std::string find_value_unit(const study::run_outline& run)
{
    const options::option* o = options::find(run.vary);
    return std::string(o != nullptr ? o->unit : run.vary.ends_with("_deg") ? "deg" : "mm");
}

std::string find_figure_unit(const study::run_outline& run, std::string_view figure)
{
    const auto is = [figure](const auto&... names) { return ((figure == names) || ...); };
    if (is("pse", "threshold"))
        return find_value_unit(run);
    if (is("jnd", "sd", "constant_error"))
        return run.on_db_axis ? "dB" : find_value_unit(run);
    if (is("error", "distance", "frechet") || figure.ends_with("_along") || figure.ends_with("_across"))
        return "mm";
    if (is("direction"))
        return "deg";
    if (is("curvature"))
        return "1/m";
    return is("correct") ? "%" : "";
}

void print_summary(const study::analysis& a)
{
    constexpr std::size_t most_lines = 10;
    say(stdout, "{}: {}{}\n", a.experiment, counted(a.participants, "participant"),
        a.simulated ? ", SIMULATED: no person gave these answers" : "");
    std::size_t room = most_lines - 1;
    std::size_t voids = 0;
    for (const study::run_analysis& r : a.runs)
        voids += r.group.empty() ? r.voids : 0;
    if (voids != 0) {
        fmt::print("{} void, not counted\n", counted(voids, "trial"));
        --room;
    }
    if (!a.excluded.empty()) {
        std::vector<std::string> who;
        for (const study::excluded_person& one : a.excluded)
            who.push_back(fmt::format("sub-{} ({})", one.participant, one.why));
        say(stdout, "excluded: {}\n", fmt::join(who, ", "));
        --room;
    }
    std::vector<std::string> lines;
    for (const study::run_analysis& r : a.runs) {
        const study::result* main = find_main_result(r.results);
        lines.push_back(fmt::format("{}: {}", r.run.name,
                                    r.n == 0 || main == nullptr ? counted(r.n, "participant")
                                                                : std::visit(summary(r.run), main->value)));
        if (r.dropped != 0)
            lines.back() += fmt::format(" ({} left out: {})", counted(r.dropped, "trial"), a.drop_rule);
        for (const auto& [factor, figures] : list_factor_tests(r.results))
            lines.push_back(fmt::format("{} by {}: {}", r.run.name, factor, fmt::join(figures, "; ")));
    }
    const std::size_t shown = lines.size() > room ? room - 1 : lines.size();
    for (std::size_t i = 0; i < shown; ++i)
        say(stdout, "{}\n", lines[i]);
    if (shown < lines.size())
        fmt::print("and {}: --format tables\n", counted(lines.size() - shown, "more result"));
}

void print_tables(const study::analysis& a)
{
    print_summary(a);
    bool tested = false;
    for (const study::run_analysis& r : a.runs) {
        print_run(a, r);
        for (const study::cell_means* v : study::list_values<study::cell_means>(r.results))
            tested = tested || (r.n != 0 && v->against);
    }
    if (tested)
        fmt::print("\n{}", wrap_text("Columns: ", column_legend));
}

void print_warnings(const study::analysis& a)
{
    for (const std::string& w : a.warnings)
        say(stderr, "tactor: warning: {}\n", w);
    if (a.no_figures.empty())
        return;
    const std::size_t more = a.no_figures.size() - 1;
    say(stderr, "tactor: warning: {}{}\n", a.no_figures.front(),
        more == 0 ? "" : fmt::format(" ({}: tactor analyze --format json)", counted(more, "more warning")));
}

} // namespace tactor::cli
