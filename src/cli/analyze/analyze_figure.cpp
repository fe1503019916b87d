// SPDX-License-Identifier: MIT
#include "cli/analyze/analyze_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "options/option.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

using study::task_kind;

// Returns the ends of an error bar.
std::optional<study::interval> find_ends(const study::t_test& t, error_bars kind,
                                         const study::interval& possible)
{
    if (kind == error_bars::se)
        return t.se ? std::optional(study::interval{*t.mean - *t.se, *t.mean + *t.se}) : std::nullopt;
    const std::optional<study::interval>& i = kind == error_bars::within ? t.ci_within : t.ci;
    return i ? std::optional(study::cut_to(*i, possible)) : std::nullopt;
}

plot::bar_series make_bars(const std::string& name, const study::by_motion& b, error_bars kind,
                           const study::interval& possible)
{
    plot::bar_series s{name};
    for (std::size_t m = 0; m < b.motion.size(); ++m)
        s.bars.push_back({*b.motion[m].mean, find_ends(b.motion[m], kind, possible), b.motion_values[m]});
    s.bars.push_back({*b.all.mean, find_ends(b.all, kind, possible), b.all_values});
    return s;
}

plot::bar_panel make_panel(const study::run_analysis& r, error_bars kind)
{
    const study::interval possible = study::possible_values(r.run);
    plot::bar_panel p;
    p.title = fmt::format("{} (n = {})", r.run.name, r.n);
    p.groups = r.run.motions;
    p.groups.emplace_back("all");
    p.joined = r.run.motions.size();
    if (r.run.task == task_kind::choose) {
        p.y_title = has_worths(r.run) ? "chosen (% of its trials)"
                                      : fmt::format("{} chosen (%)", r.run.methods.back());
        p.level = 50.0;
        p.y_to = 100.0;
    } else if (r.run.task == task_kind::rate) {
        p.y_title = "mean rating";
        p.y_from = r.run.lowest_rating();
        p.y_to = r.run.scale;
    } else { // identify
        p.y_title = "correct (%)";
        p.level = study::chance(r.run);
        p.y_to = 100.0;
    }
    if (r.run.task == task_kind::choose && !has_worths(r.run)) {
        p.series.push_back(make_bars("", r.cells[0], kind, possible));
        return p;
    }
    for (std::size_t m = 0; m < r.run.methods.size(); ++m)
        p.series.push_back(make_bars(r.run.methods[m], r.cells[m], kind, possible));
    return p;
}

// Draws d' of each condition, or of all trials. Nothing where no participant has one.
std::optional<plot::bar_panel> make_sensitivity_panel(const study::run_analysis& r, error_bars kind)
{
    constexpr double unbounded = std::numeric_limits<double>::infinity();
    plot::bar_panel p{fmt::format("{} (n = {})", r.run.name, r.n), "d'"};
    p.level = 0.0;
    plot::bar_series s;
    bool everybody = true;
    for (std::size_t i = r.measures.size() > 1 ? 1 : 0; i < r.measures.size(); ++i) {
        const study::measured_condition& c = r.measures[i];
        const auto at = std::ranges::find(c.figures, "dprime", &decltype(c.figures)::value_type::first);
        if (at == c.figures.end() || !at->second.mean)
            continue;
        plot::bar b{*at->second.mean, find_ends(at->second, kind, {-unbounded, unbounded})};
        for (const study::person_measures& m : c.people)
            if (m.detected)
                b.values.push_back(m.detected->found.dprime);
        everybody = everybody && b.values.size() == r.n;
        std::vector<double> all = b.values;
        if (b.error)
            all.insert(all.end(), {b.error->first, b.error->second});
        const auto [low, high] = std::ranges::minmax(all);
        p.y_from = std::min(p.y_from, 1.1 * low);
        p.y_to = std::max(p.y_to, 1.1 * high);
        p.groups.push_back(c.name.empty() ? "all" : c.name);
        s.bars.push_back(std::move(b));
    }
    if (s.bars.empty())
        return {};
    p.joined = everybody ? p.groups.size() : 0; // by place: a value for each participant
    p.series.push_back(std::move(s));
    return p;
}

// Names what a run varies, and its unit, for an axis: "level (dBFS)", "length (mm)".
std::string axis_title(const study::run_outline& r)
{
    const options::option* o = options::find(r.vary);
    std::string name(o != nullptr ? o->name : r.vary);
    const std::string unit(o != nullptr ? o->unit : r.vary.ends_with("_deg") ? "deg" : "mm");
    std::string end = "_" + in_small_letters(unit);
    std::ranges::replace(end, '/', '_');
    if (name.ends_with(end))
        name.resize(name.size() - end.size());
    std::ranges::replace(name, '_', ' ');
    return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

// Returns the axis of the values, with the standard.
plot::curve_axis make_value_axis(const study::run_outline& r, bool logs)
{
    constexpr double space = 0.05;
    const auto place = [logs](double v) { return logs ? std::log10(v) : v; };
    plot::curve_axis x{axis_title(r), place(r.values.front()), place(r.values.back())};
    x.logs = logs;
    if (r.standard && (!logs || *r.standard > 0.0)) {
        x.level = place(*r.standard);
        x.from = std::min(x.from, *x.level);
        x.to = std::max(x.to, *x.level);
    }
    const double width = x.to - x.from;
    x.from -= space * width;
    x.to += space * width;
    return x;
}

// Samples a psychometric function, in per cent.
std::vector<plot::spot> sample_function(const study::psychometric& p, const study::psychometric_family& f,
                                        const plot::curve_axis& x)
{
    constexpr int steps = 400;
    std::vector<plot::spot> line;
    for (int i = 0; i <= steps; ++i) {
        const double at = x.from + (x.to - x.from) * i / steps;
        line.push_back({at, 100.0 * study::chance(at, p, f)});
    }
    return line;
}

// Returns the function of the mean pse or threshold, and of the mean jnd.
std::optional<plot::curve> make_mean_function(const study::run_analysis& r,
                                              const study::measured_condition& c, const plot::curve_axis& x)
{
    std::vector<double> slopes;
    std::vector<double> guesses;
    for (const study::person_measures& m : c.people)
        if (m.fit && !m.fit->step) {
            slopes.push_back(m.fit->parameters.slope);
            guesses.push_back(m.guess);
        }
    if (slopes.empty())
        return {};
    return plot::curve{.thick = true,
                       .line =
                           sample_function({*c.figures.front().second.mean, study::mean(slopes)},
                                           study::find_family(r.run, r.function, study::mean(guesses)), x)};
}

plot::curve make_person_curve(const study::run_analysis& r, const study::person_measures& m,
                              const plot::curve_axis& x)
{
    plot::curve one;
    if (m.fit)
        one.line = sample_function(m.fit->parameters, study::find_family(r.run, r.function, m.guess), x);
    for (const study::answer_block& b : m.blocks)
        one.dots.push_back(
            {{b.x, 100.0 * static_cast<double>(b.k) / static_cast<double>(b.n)}, static_cast<double>(b.n)});
    for (const study::value_estimate& e : m.estimates) {
        const plot::spot at{x.logs ? std::log10(e.value) : e.value, std::log10(e.ratio)};
        one.line.push_back(at);
        one.dots.push_back({at, static_cast<double>(e.n)});
    }
    return one;
}

// Returns the geometric means of the participants' estimates, of which those of one place are its values.
std::optional<plot::curve> average_estimates(const std::vector<plot::curve>& people)
{
    std::map<double, std::vector<double>> by_value;
    for (const plot::curve& one : people)
        for (const plot::spot& v : one.line)
            by_value[v.x].push_back(v.y);
    plot::curve all{.thick = true};
    for (const auto& [x, logs] : by_value)
        all.line.push_back({x, study::mean(logs)});
    return all.line.empty() ? std::nullopt : std::optional(all);
}

// Names what the answers are counted of.
std::string answers_title(const study::run_outline& r)
{
    if (r.task == task_kind::detect)
        return "felt (%)";
    return r.standard ? "comparison chosen (%)"
                      : fmt::format("answered \"{}\" (%)", r.choices.size() == 2 ? r.choices[1] : "");
}

plot::curve_axis make_answer_axis(const study::run_analysis& r)
{
    constexpr double space = 0.05;
    if (r.run.task != task_kind::estimate)
        return {answers_title(r.run), -100.0 * space, 100.0 * (1.0 + space), 50.0};
    plot::curve_axis y{"estimate / participant's mean", 0.0, 0.0, {}, true};
    for (const study::measured_condition& c : r.measures)
        for (const study::person_measures& m : c.people)
            for (const study::value_estimate& e : m.estimates) {
                y.from = std::min(y.from, std::log10(e.ratio));
                y.to = std::max(y.to, std::log10(e.ratio));
            }
    const double width = std::max(space, y.to - y.from);
    y.from -= space * width;
    y.to += space * width;
    return y;
}

// Names a condition with the exponent that was found in it, and then the run: a narrow panel cuts the end.
std::string curves_title(const study::run_analysis& r, const study::measured_condition& c)
{
    std::string exponent;
    if (r.run.task == task_kind::estimate && c.figures.front().second.mean)
        exponent = fmt::format(", exponent {:.2f}", *c.figures.front().second.mean);
    return c.name.empty() ? fmt::format("{} (n = {}){}", r.run.name, r.n, exponent)
                          : fmt::format("{}{} ({}, n = {})", c.name, exponent, r.run.name, r.n);
}

// Draws the participants' curves in each condition with their mean, after the means of all conditions.
void add_curves(plot::panel_figure& f, const study::run_analysis& r)
{
    const bool estimates = r.run.task == task_kind::estimate;
    const bool several = r.measures.size() > 1;
    const plot::curve_axis x = make_value_axis(r.run, estimates && !r.run.on_db_axis);
    const plot::curve_axis y = make_answer_axis(r);
    plot::curve_panel means{fmt::format("{} (n = {}): means", r.run.name, r.n), x, y};
    std::vector<plot::curve_panel> panels;
    for (std::size_t i = several ? 1 : 0; i < r.measures.size(); ++i) {
        const study::measured_condition& c = r.measures[i];
        plot::curve_panel& p = panels.emplace_back(plot::curve_panel{curves_title(r, c), x, y});
        double most = 0.0;
        for (const study::person_measures& m : c.people) {
            p.curves.push_back(make_person_curve(r, m, x));
            p.curves.back().colour = panels.size() - 1;
            for (const plot::weighted_dot& d : p.curves.back().dots)
                most = std::max(most, d.weight);
        }
        p.key = fmt::format("largest point: {}", counted(static_cast<std::uint64_t>(most), "trial"));
        std::optional<plot::curve> mean =
            estimates ? average_estimates(p.curves) : make_mean_function(r, c, x);
        if (!mean)
            continue;
        mean->colour = panels.size() - 1;
        if (r.n > 1)
            p.curves.push_back(*mean);
        mean->name = c.name;
        means.curves.push_back(*std::move(mean));
    }
    if (means.curves.size() > 1)
        f.curves.push_back(std::move(means));
    f.curves.insert(f.curves.end(), panels.begin(), panels.end());
}

// Says what is drawn.
std::string describe_panels(const plot::panel_figure& f, const study::analysis& a, error_bars kind)
{
    std::vector<std::string> notes;
    if (!f.bars.empty())
        notes.push_back(
            fmt::format("Means over participants; error bars: {}; dots and thin lines: participants.",
                        all_error_bars[static_cast<std::size_t>(kind)].second));
    const auto has = [&a](const auto& what) {
        return std::ranges::any_of(a.runs, [&](const study::run_analysis& r) {
            return std::ranges::any_of(r.measures, [&](const study::measured_condition& c) {
                return std::ranges::any_of(c.people, what);
            });
        });
    };
    if (!f.curves.empty())
        notes.emplace_back("Thin lines and points: participants; the area of a point grows with its trials.");
    if (std::ranges::any_of(f.curves, [](const plot::curve_panel& p) { return p.curves.back().thick; }))
        notes.emplace_back("Thick: functions of the means of the participants' figures.");
    if (has([](const study::person_measures& m) { return !m.blocks.empty() && !m.fit; }))
        notes.emplace_back("Points without a line: answers that determine no function.");
    if (has([](const study::person_measures& m) { return !m.estimates.empty(); }))
        notes.emplace_back("Estimates: geometric means, divided by that of the participant.");
    if (!f.matrices.empty())
        notes.emplace_back("Answers: their number; darker cells are larger shares of the played motion.");
    return plot::join(notes, " ");
}

} // namespace

plot::canvas draw_analysis(const study::analysis& a, const picture_options& o, error_bars kind)
{
    plot::panel_figure f;
    f.title = o.choose_title(a.experiment);
    f.heading = o.has_title();
    f.width_mm = o.width_mm;
    f.across = a.simulated ? "simulated" : "";
    for (const study::run_analysis& r : a.runs) {
        if (r.n == 0)
            continue;
        if (!find_task(r.run.task).about().measures)
            f.bars.push_back(make_panel(r, kind));
        else if (!r.run.vary.empty())
            add_curves(f, r);
        else if (std::optional<plot::bar_panel> p = make_sensitivity_panel(r, kind))
            f.bars.push_back(*std::move(p));
        for (std::size_t m = 0; m < r.confusion.size(); ++m)
            f.matrices.push_back({fmt::format("{}: answers with {}", r.run.name, r.run.methods[m]), "played",
                                  "answered", r.run.motions, r.confusion[m]});
    }
    f.note = describe_panels(f, a, kind);
    return plot::draw_panels(f);
}

} // namespace tactor::cli
