// SPDX-License-Identifier: MIT
#include "cli/analyze/analyze_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "cli/say.hpp"
#include "core/words.hpp"
#include "study/analysis/analysis.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;
using study::task_kind;

std::string value_text(std::optional<double> v, int decimals = 2)
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

std::string interval_text(const std::optional<study::interval>& i, int decimals = 2)
{
    return i ? fmt::format("{:.{}f} ... {:.{}f}", i->first, decimals, i->second, decimals) : "-";
}

std::string interval_text(const std::optional<study::interval>& i, const study::interval& possible)
{
    return i ? interval_text(study::cut_to(*i, possible)) : "-";
}

// Needs a test that has a t.
std::string t_text(const study::t_test& t)
{
    return fmt::format("t({:.0f}) = {:.2f}, {}", *t.df, *t.t, p_clause(t.p));
}

// Needs an effect that has an F.
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

void print_tests(const study::by_motion& b, const std::vector<std::string>& motions)
{
    const std::size_t w = widest(motions);
    fmt::print("  {:<{}} {:>6} {:>5} {:>16} {:>6} {:>5} {:>5} {:>5}  {}\n", "", w, "mean", "se", "95 %", "t",
               "p", "Holm", "signs", "d");
    const auto row = [&](const std::string& name, const study::t_test& t, std::optional<double> holm) {
        say(stdout, "  {:<{}} {:>6} {:>5} {:>16} {:>6} {:>5} {:>5} {:>5}  {}\n", name, w, value_text(t.mean),
            value_text(t.se), interval_text(t.ci, study::per_cents), value_text(t.t), p_text(t.p),
            p_text(holm), p_text(t.p_signflip), value_text(t.d));
    };
    row("all", b.all, {});
    for (std::size_t m = 0; m < motions.size(); ++m)
        row(motions[m], b.motion[m], b.p_holm[m]);
    if (b.all.t)
        fmt::print("  all: {}; d = {:.2f} ({})\n", t_text(b.all), *b.all.d, interval_text(b.all.d_ci));
}

constexpr const char* column_legend =
    "mean and se (standard error) are over participants, in per cent; 95 % is the interval of the mean, cut "
    "to 0 to 100; t and p compare the mean with what guessing gives (two-sided); Holm is p adjusted for the "
    "number of motions; signs is the exact p of all changes of sign; d is the effect size, (mean - guessing) "
    "/ sd.";

void print_effect(const std::string& name, const study::effect& e)
{
    if (e.f)
        fmt::print("{}", wrapped(fmt::format("  {}: ", name), effect_text(e)));
}

void print_pairs(const std::vector<study::comparison>& pairs, const std::vector<std::string>& motions,
                 const std::string& of)
{
    if (pairs.empty() || !pairs[0].q)
        return;
    say(stdout, "  Tukey{}:\n", of);
    const std::size_t w = widest(motions);
    for (const study::comparison& c : pairs)
        say(stdout, "    {:<{}} - {:<{}} {:>7} q = {:>5}, {}\n", motions[c.a], w, motions[c.b], w,
            value_text(c.difference), value_text(c.q), p_clause(c.p));
}

void print_worths(const study::run_analysis& r)
{
    for (std::size_t m = 0; m < r.cells.size(); ++m) {
        say(stdout, "  per cent of the trials with {} in which people chose it, against 50\n",
            r.run.methods[m]);
        print_tests(r.cells[m], r.run.motions);
    }
    const std::size_t w = widest(r.run.methods);
    say(stdout, "  Bradley-Terry: log worth (se) relative to {}\n", r.run.methods.front());
    for (std::size_t m = 1; m < r.worths.size(); ++m)
        say(stdout, "    {:<{}} {:>6} ({})\n", r.run.methods[m], w, value_text(r.worths[m].log_worth),
            value_text(r.worths[m].se));
}

void print_paired(const std::vector<study::paired_comparison>& pairs, const std::vector<std::string>& motions)
{
    if (pairs.empty() || pairs[0].test.n < 2)
        return;
    fmt::print("  pairs of motions, paired t; Holm is p adjusted for the number of pairs:\n");
    const std::size_t w = widest(motions);
    for (const study::paired_comparison& c : pairs)
        say(stdout, "    {:<{}} - {:<{}} {:>7} t = {:>5}, {}, Holm {}\n", motions[c.a], w, motions[c.b], w,
            value_text(c.test.mean), value_text(c.test.t), p_clause(c.test.p), p_text(c.p_holm));
}

void print_choose(const study::run_analysis& r)
{
    if (has_worths(r.run))
        print_worths(r);
    else {
        say(stdout, "  per cent of trials in which people chose {}, against 50\n", r.run.methods.back());
        print_tests(r.cells[0], r.run.motions);
    }
    const study::t_test& first = r.first_interval;
    if (first.mean)
        fmt::print("  first interval chosen: {:.1f} %{}\n", *first.mean, first.t ? ", " + t_text(first) : "");
    print_effect("motion", r.effects.second);
    for (const std::vector<study::comparison>& pairs : r.pairs)
        print_pairs(pairs, r.run.motions, "");
}

std::string paired_text(const study::t_test& t)
{
    std::string text = value_text(t.mean);
    if (t.t)
        text += fmt::format(" ({}), {}", interval_text(t.ci), t_text(t));
    if (t.p_signflip)
        text += fmt::format(", signs {}", p_text(t.p_signflip));
    if (t.d)
        text += fmt::format("; d_z = {:.2f} ({})", *t.d, interval_text(t.d_ci));
    return text;
}

void print_rate(const study::run_analysis& r)
{
    say(stdout, "  mean rating (se), {}\n", study::rating_range(r.run));
    const std::size_t w = widest(r.run.methods);
    const auto cell = [](const study::t_test& t) {
        return fmt::format("{} ({})", value_text(t.mean), value_text(t.se));
    };
    for (std::size_t m = 0; m < r.run.methods.size(); ++m) {
        say(stdout, "  {:<{}} all {}", r.run.methods[m], w, cell(r.cells[m].all));
        fmt::print(", 95 % {}\n", interval_text(r.cells[m].all.ci, study::possible_values(r.run)));
        for (std::size_t k = 0; k < r.run.motions.size(); ++k)
            say(stdout, "  {:<{}} {} {}\n", "", w, r.run.motions[k], cell(r.cells[m].motion[k]));
    }
    if (r.run.methods.size() > 1 && r.paired.mean)
        say(stdout, "{}",
            wrapped(fmt::format("  {} - {}: ", r.run.methods.back(), r.run.methods.front()),
                    paired_text(r.paired)));
    print_effect("method", r.effects.first);
    print_effect("motion", r.effects.second);
    print_effect("method:motion", r.effects.interaction);
    for (std::size_t m = 0; m < r.run.methods.size(); ++m)
        print_pairs(r.pairs[m], r.run.motions, " within " + r.run.methods[m]);
}

void print_identify(const study::run_analysis& r)
{
    const std::size_t w = widest(r.run.motions);
    for (std::size_t m = 0; m < r.run.methods.size(); ++m) {
        say(stdout, "  {}: per cent correct, against {:.2f}\n", r.run.methods[m], study::chance(r.run));
        print_tests(r.cells[m], r.run.motions);
        print_paired(r.paired_motions[m], r.run.motions);
        say(stdout, "  answers, from left to right in the order of the rows:\n");
        for (std::size_t i = 0; i < r.run.motions.size(); ++i)
            say(stdout, "    {:<{}} {:>5}\n", r.run.motions[i], w, fmt::join(r.confusion[m][i], " "));
    }
}

// Names a figure with the value against which it is tested, if any.
std::string figure_text(const study::run_outline& run, std::string_view figure, bool is_main)
{
    const auto against = study::measured_against(run);
    const std::string name = figure == "dprime" ? "d'" : std::string(figure);
    return is_main && against ? fmt::format("{} against {}", name, *against) : name;
}

// Returns the decimals of a figure: of one in the unit of the values as many as a hundredth of their range
// has, two at least.
int count_decimals(const study::run_outline& run, std::string_view figure)
{
    constexpr int usual = 2;
    if (figure != "pse" && figure != "jnd" && figure != "threshold")
        return usual;
    const double range = run.values.back() - run.values.front();
    return std::max(usual, usual - static_cast<int>(std::floor(std::log10(range))));
}

void print_measures(const study::run_analysis& r)
{
    if (!r.run.vary.empty())
        say(stdout, "  {} {}{}\n", r.run.vary,
            r.run.task == task_kind::adaptive ? "by procedure" : "over values",
            r.run.standard ? fmt::format(", standard {}", *r.run.standard) : "");
    for (const study::measured_condition& c : r.measures) {
        if (!c.name.empty())
            say(stdout, "  {}\n", c.name);
        for (std::size_t k = 0; k < c.figures.size(); ++k) {
            const auto& [figure, t] = c.figures[k];
            const int decimals = count_decimals(r.run, figure);
            std::string test;
            if (k == 0 && c.difference)
                test = fmt::format(", likelihood ratio {:.2f}, {}", c.difference->likelihood_ratio,
                                   p_clause(c.difference->p));
            else if (k == 0 && t.t && study::measured_against(r.run))
                test = ", " + t_text(t);
            say(stdout, "  {:<22} {:>8} (se {}), 95 % {}{}\n", figure_text(r.run, figure, k == 0),
                value_text(t.mean, decimals), value_text(t.se, decimals), interval_text(t.ci, decimals),
                test);
        }
        if (!c.name.empty())
            continue;
        const std::size_t w = widest(r.codes);
        for (std::size_t i = 0; i < r.codes.size(); ++i) {
            std::string row;
            for (const auto& [figure, value] : study::list_measures(r.run, c.people[i]))
                row += fmt::format("  {} {}", figure, value_text(value, count_decimals(r.run, figure)));
            if (const auto& b = c.people[i].bootstrap; b.p_gof)
                row += fmt::format("  {} {}  fit p {}", c.figures.front().first,
                                   interval_text(b.threshold, count_decimals(r.run, c.figures.front().first)),
                                   p_text(b.p_gof));
            say(stdout, "    sub-{:<{}}{}\n", r.codes[i], w, row);
        }
    }
}

// Prints the median response time, and the conditions with the shortest and the longest.
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
    say(stdout, "{}", wrapped("  response time: ", text));
}

// Returns what Park et al. (2016) report of a run of theirs, or nothing.
std::string_view in_the_paper(std::string_view experiment, std::string_view run)
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
    say(stdout, "\n{}: {}, {}, {}\n", r.run.name, to_string(r.run.task), counted(r.n, "participant"),
        counted(r.trials, "trial"));
    if (r.early != 0)
        fmt::print("  {} early (sooner after the stimulus than min_response_s), counted\n",
                   counted(r.early, "answer"));
    if (r.n == 0)
        return;
    print_times(r.times);
    if (r.run.task == task_kind::choose)
        print_choose(r);
    else if (r.run.task == task_kind::rate)
        print_rate(r);
    else if (r.run.task == task_kind::identify)
        print_identify(r);
    else
        print_measures(r);
    const auto by_group = study::list_group_effects(r);
    if (std::ranges::any_of(by_group, [](const auto& one) { return one.second && one.second->f; }))
        fmt::print("  groups compared:\n");
    for (const auto& [name, e] : by_group)
        if (e != nullptr)
            print_effect(fmt::format("  {}", name), *e);
    if (const std::string_view paper = in_the_paper(a.experiment, r.run.name); !paper.empty())
        say(stdout, "{}", wrapped("  Park et al. 2016: ", std::string(paper)));
}

// Writes the model of Bradley and Terry: a column for each method but the first, 1 where it was felt first,
// -1 where it was felt second. The intercept is the preference for the first interval. `factors`: "1", or
// those that the worths may depend on.
std::string write_worth_model(const study::run_outline& r, const std::string& factors)
{
    std::string others;
    for (std::size_t m = 1; m < r.methods.size(); ++m)
        others += (m > 1 ? ", " : "") + json(r.methods[m]).dump();
    return fmt::format("glmer(chosen ~ worth{} + (1 + worth | participant), family = binomial, "
                       "data = within(subset(d, run == {}), "
                       "worth <- sapply(c({}), function(m) (method == m) - (other == m))))",
                       factors == "1" ? "" : " + worth:" + factors, json(r.name).dump(), others);
}

// Writes the values of a run less the standard, or the middle of them: effects of methods and groups are
// those there. Estimates follow the logarithm of a value that is no level.
std::string write_value(const study::run_outline& r)
{
    const double low = r.values.front();
    const double high = r.values.back();
    if (r.task == task_kind::estimate && !r.on_db_axis)
        return fmt::format("log(value / {})", plain_number(r.standard.value_or(std::sqrt(low * high)), 12));
    const double at = r.standard.value_or(0.5 * (low + high));
    return fmt::format("I(value {} {})", at < 0.0 ? '+' : '-', plain_number(std::abs(at), 12));
}

// The model of a run. People differ in what is asked about, too: without its slope for each of them, such a
// difference passes for an effect of all. Nothing of the stimuli is taken to be a sample.
std::string write_model(const study::run_outline& r, const std::vector<study::group_outline>& groups)
{
    std::string motion = r.motions.size() > 1 ? "motion" : "1";
    if (study::has_groups(r, groups))
        motion = motion == "1" ? "group" : "(group * motion)";
    const bool has_method =
        r.task != task_kind::choose && r.task != task_kind::same_different && r.methods.size() > 1;
    std::vector<std::string> factors;
    // The slope over the values, or over whether there was a signal, is what the run is about. The method of
    // a trial without a stimulus is "none", which says it, too.
    if (!r.vary.empty())
        factors.push_back(write_value(r));
    else if (r.task == task_kind::same_different || (r.catches && !has_method))
        factors.emplace_back("signal");
    std::vector<std::string> people{"1"};
    people.insert(people.end(), factors.begin(), factors.end());
    if (has_method || r.motions.size() > 1)
        people.emplace_back(has_method ? "method" : "motion");
    if (has_method)
        factors.emplace_back("method");
    if (motion != "1" || factors.empty())
        factors.push_back(motion);
    // R reads the texts of JSON.
    const std::string rest =
        fmt::format("{} + {}({} | participant), ", fmt::join(factors, " * "),
                    r.task == task_kind::choose ? "order + " : "", fmt::join(people, " + "));
    const std::string data = fmt::format("data = subset(d, run == {})", json(r.name).dump());
    switch (r.task) {
    case task_kind::choose:
        return has_worths(r) ? write_worth_model(r, motion)
                             : fmt::format("glmer(chosen ~ {}family = binomial, {})", rest, data);
    case task_kind::rate:
        return fmt::format("lmer(rating ~ {}{})", rest, data);
    case task_kind::estimate:
        return fmt::format("lmer(log(estimate) ~ {}{})", rest, data);
    case task_kind::identify:
        return fmt::format("glmer(correct ~ {}family = binomial, {})", rest, data);
    default:
        return fmt::format("glmer(positive ~ {}family = binomial(\"probit\"), {})", rest, data);
    }
}

// A column of the trials.
struct trial_column {
    const char* name;
    std::string (*cell)(const study::trial& t, const study::run_outline& r);
    bool (*needed)(const study::run_outline& r) noexcept = nullptr; ///< by a run; null: in all studies
};

bool is_measured(const study::run_outline& r) noexcept
{
    return find_task(r.task).about().measures;
}

bool has_values(const study::run_outline& r) noexcept
{
    return !r.vary.empty();
}

// Returns the method that a trial of choose asks about: the last of two; of three or more the one felt first.
std::size_t asked_method(const study::trial& t, const study::run_outline& r)
{
    return has_worths(r) ? t.method_1 : r.methods.size() - 1;
}

constexpr trial_column trial_columns[] = {
    {"run", [](const auto&, const auto& r) { return r.name; }},
    {"task", [](const auto&, const auto& r) { return std::string(to_string(r.task)); }},
    {"trial", [](const auto& t, const auto&) { return fmt::format("{}", t.place); }},
    {"attempt", [](const auto& t, const auto&) { return fmt::format("{}", t.attempt); }},
    {"motion", [](const auto& t, const auto& r) { return r.motions[t.motion]; }},
    {"method",
     [](const auto& t, const auto& r) {
         return r.catches && !t.signal
                    ? std::string(study::catch_name)
                    : r.methods[r.task == task_kind::choose ? asked_method(t, r) : t.method_1];
     }},
    {"other",
     [](const auto& t, const auto& r) -> std::string {
         return r.task != task_kind::choose
                    ? "n/a"
                    : r.methods[t.method_1 == asked_method(t, r) ? t.method_2 : t.method_1];
     },
     study::has_worths},
    {"order",
     [](const auto& t, const auto& r) -> std::string {
         return r.task != task_kind::choose ? "n/a" : t.method_1 == asked_method(t, r) ? "0.5" : "-0.5";
     }},
    {"response",
     [](const auto& t, const auto& r) {
         return r.task == task_kind::identify   ? r.motions[t.response]
                : r.task == task_kind::estimate ? fmt::format("{}", t.estimate)
                                                : fmt::format("{}", t.response);
     }},
    {"chosen",
     [](const auto& t, const auto& r) -> std::string {
         return r.task != task_kind::choose ? "n/a" : chosen_method(t) == asked_method(t, r) ? "1" : "0";
     }},
    {"rating",
     [](const auto& t, const auto& r) {
         return r.task == task_kind::rate ? fmt::format("{}", t.response) : "n/a";
     }},
    {"correct",
     [](const auto& t, const auto& r) -> std::string {
         return r.task != task_kind::identify ? "n/a" : t.response == t.motion ? "1" : "0";
     }},
    {"value",
     [](const auto& t, const auto& r) -> std::string {
         return r.vary.empty() || !t.signal ? "n/a" : fmt::format("{}", t.value);
     },
     has_values},
    {"signal",
     [](const auto& t, const auto& r) -> std::string {
         return !is_measured(r) ? "n/a" : t.signal ? "1" : "0";
     },
     is_measured},
    {"positive",
     [](const auto& t, const auto& r) -> std::string {
         return !is_measured(r) || r.task == task_kind::estimate ? "n/a" : t.positive ? "1" : "0";
     },
     is_measured},
    {"estimate",
     [](const auto& t, const auto& r) {
         return r.task == task_kind::estimate ? fmt::format("{}", t.estimate) : "n/a";
     },
     [](const study::run_outline& r) noexcept { return r.task == task_kind::estimate; }},
    {"response_time",
     [](const auto& t, const auto&) {
         return t.response_time_s ? fmt::format("{}", *t.response_time_s) : "n/a";
     }},
    {"early",
     [](const auto& t, const auto&) -> std::string {
         return !t.early ? "n/a" : *t.early ? "true" : "false";
     }},
};

// Returns a name for a column that SPSS, JASP and R take as it is: RUN.METHOD.MOTION or RUN.FIGURE of at most
// 64 letters, digits, dots and underscores, with a letter first and no dot last. Adds it to `taken`, where no
// two differ in case only.
std::string name_column(const std::vector<std::string>& parts, std::set<std::string>& taken)
{
    constexpr std::size_t longest = 60; // leaves room for a number
    std::size_t length = parts.size() - 1;
    for (const std::string& part : parts)
        length += part.size();
    const bool fits = length < longest;
    std::string name;
    for (const std::string& part : parts) {
        name += name.empty() ? "" : ".";
        for (const char c : first_characters(part, fits ? longest : longest / 3 - 1))
            if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.')
                name += c;
            else if ((static_cast<unsigned char>(c) & 0xc0U) != 0x80U) // one for each character of UTF-8
                name += '_';
    }
    if (const char first = in_small_letters(name)[0]; first < 'a' || first > 'z')
        name.insert(0, "x");
    if (name.back() == '.')
        name.back() = '_';
    std::string unique = name;
    for (unsigned n = 2; !taken.insert(in_small_letters(unique)).second; ++n)
        unique = fmt::format("{}_{}", name, n);
    return unique;
}

// Returns the place of a name; the size where it is none of them.
std::size_t find_place(const std::vector<std::string>& names, const std::string& name)
{
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

// Returns a trial of a group with the places of its motions and methods in the whole run.
study::trial move_to(study::trial t, const study::run_outline& own, const study::run_outline& whole)
{
    t.motion = find_place(whole.motions, own.motions[t.motion]);
    t.method_1 = find_place(whole.methods, own.methods[t.method_1]);
    t.method_2 = find_place(whole.methods, own.methods[t.method_2]);
    if (whole.task == task_kind::identify)
        t.response = static_cast<unsigned>(find_place(whole.motions, own.motions[t.response]));
    return t;
}

} // namespace

void print_analysis_text(const study::analysis& a)
{
    say(stdout, "{}: {}{}\n", a.experiment, counted(a.participants, "participant"),
        a.simulated ? ", SIMULATED: no person gave these answers" : "");
    std::size_t voids = 0;
    for (const study::run_analysis& r : a.runs)
        voids += r.group.empty() ? r.voids : 0;
    if (voids != 0)
        fmt::print("{} void, not counted\n", counted(voids, "trial"));
    for (const study::left_out& one : a.excluded)
        say(stdout, "excluded: sub-{} ({})\n", one.participant, one.why);
    for (const study::run_analysis& r : a.runs)
        print_run(a, r);
    if (std::ranges::any_of(a.runs, [](const auto& r) {
            return r.n != 0 && r.run.task != task_kind::rate && !is_measured(r.run);
        }))
        fmt::print("\n{}", wrapped("Columns: ", column_legend));
}

void print_warnings(const study::analysis& a)
{
    for (const std::string& w : a.warnings)
        say(stderr, "tactor: warning: {}\n", w);
    if (a.no_figures.empty())
        return;
    const std::size_t more = a.no_figures.size() - 1;
    say(stderr, "tactor: warning: {}{}\n", a.no_figures.front(),
        more == 0 ? "" : fmt::format(" ({}: --format json)", counted(more, "more warning")));
}

void print_trials(const study::dataset& d)
{
    std::string text;
    if (d.simulated)
        text += "# simulated: no person gave these answers\n";
    // Names may have "#" in them: the notes are counted, not told by their first letter.
    const std::size_t notes = 3 + (d.simulated ? 1 : 0) + d.experiment.runs.size();
    // With sum contrasts an effect is over all motions, not that at the first one.
    text += fmt::format("# library(lme4)\n"
                        "# options(contrasts = c(\"contr.sum\", \"contr.poly\"))\n"
                        "# d <- read.delim(\"trials.tsv\", skip = {}, na.strings = \"n/a\", quote = \"\", "
                        "colClasses = c(participant = \"character\"))\n",
                        notes);
    for (const study::run_outline& r : d.experiment.runs)
        text += fmt::format("# {}\n", write_model(r, d.experiment.groups));
    std::vector<trial_column> columns(std::begin(trial_columns), std::end(trial_columns));
    std::erase_if(columns, [&](const trial_column& c) {
        return c.needed != nullptr && std::ranges::none_of(d.experiment.runs, c.needed);
    });
    const bool grouped = !d.experiment.groups.empty();
    const bool several = d.experiment.sessions > 1;
    text += fmt::format("participant{}{}", grouped ? "\tgroup" : "", several ? "\tsession" : "");
    for (const trial_column& c : columns)
        text += fmt::format("\t{}", c.name);
    text += '\n';
    for (std::size_t i = 0; i < d.participants.size(); ++i)
        for (std::size_t k = 0; k < d.experiment.runs.size(); ++k)
            for (const study::trial& own : d.data[i][k].trials) {
                const study::trial t = move_to(own, find_run(d, i, k), d.experiment.runs[k]);
                text += d.participants[i];
                text += grouped ? "\t" + d.groups[i] : "";
                text += several ? fmt::format("\t{}", own.session.value()) : "";
                for (const trial_column& c : columns)
                    text += "\t" + c.cell(t, d.experiment.runs[k]);
                text += '\n';
            }
    fmt::print("{}", text);
}

void print_wide(const study::dataset& d, study::sigmoid kind)
{
    const bool grouped = !d.experiment.groups.empty();
    std::string text = d.simulated ? "participant_id,simulated" : "participant_id";
    text += grouped ? ",group" : "";
    std::set<std::string> taken;
    for (const study::run_outline& r : d.experiment.runs) {
        if (is_measured(r)) {
            for (const auto& [figure, none] : study::list_measures(r, {}))
                text += "," + name_column({r.name, std::string(figure)}, taken);
            continue;
        }
        for (const std::string& method : study::row_methods(r))
            for (const std::string& motion : r.motions)
                text += "," + name_column({r.name, method, motion}, taken);
    }
    text += '\n';
    for (std::size_t i = 0; i < d.participants.size(); ++i) {
        text += fmt::format("sub-{}{}", d.participants[i], d.simulated ? ",true" : "");
        text += grouped ? "," + json(d.groups[i]).dump() : ""; // quotes it
        for (std::size_t k = 0; k < d.experiment.runs.size(); ++k) {
            const study::run_outline& own = find_run(d, i, k);
            if (is_measured(own)) {
                const auto measured = study::measure_trials(own, d.data[i][k].trials, kind, "");
                for (const auto& [figure, value] : study::list_measures(own, measured))
                    text += value ? fmt::format(",{}", *value) : ",";
                continue;
            }
            const std::vector<std::string> methods = study::row_methods(own);
            const auto cells = study::compute_cells(own, d.data[i][k].trials);
            for (const std::string& method : study::row_methods(d.experiment.runs[k]))
                for (const std::string& motion : d.experiment.runs[k].motions) {
                    const std::size_t row = find_place(methods, method);
                    const std::size_t m = find_place(own.motions, motion);
                    text += cells && row < methods.size() && m < own.motions.size()
                                ? fmt::format(",{}", (*cells)[row][m])
                                : ",";
                }
        }
        text += '\n';
    }
    fmt::print("{}", text);
}

} // namespace tactor::cli
