// SPDX-License-Identifier: MIT
#include "cli/analyze/analyze_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/analyze/analyze_output.hpp"
#include "core/words.hpp"
#include "options/option.hpp"

namespace tactor::cli {
namespace {

// The quantity of an axis.
struct quantity {
    std::string name;
    std::string unit = {};

    std::string title() const { return unit.empty() ? name : fmt::format("{} ({})", name, unit); }
};

// Returns the quantity that a run varies: level in dBFS, length in mm. The run must vary one.
quantity find_varied(const study::run_outline& r)
{
    const options::option* o = options::find(r.vary);
    quantity q{std::string(o != nullptr ? o->name : r.vary), find_value_unit(r)};
    std::string end = "_" + to_lower_case(q.unit);
    std::ranges::replace(end, '/', '_');
    if (q.name.ends_with(end))
        q.name.resize(q.name.size() - end.size());
    std::ranges::replace(q.name, '_', ' ');
    return q;
}

// Returns the quantity of a figure, such as "jnd" or "constant_along".
quantity find_quantity(const study::run_outline& r, const std::string& figure)
{
    static const std::map<std::string_view, std::string_view> names{
        {"dprime", "d'"},
        {"c", "criterion c"},
        {"constant_along", "constant error along y"},
        {"constant_across", "constant error along x"},
        {"variable_along", "variable error along y"},
        {"variable_across", "variable error along x"},
        {"frechet", "Frechet distance"},
        {"length", "length / target's length"}};
    const auto found = names.find(figure);
    quantity q{found != names.end() ? std::string(found->second) : figure, find_figure_unit(r, figure)};
    if (figure == "constant_error")
        q.name = "constant error of " + find_varied(r).name;
    return q;
}

// Returns the two ends of an error bar.
std::optional<study::interval> find_ends(const study::t_test& t, error_bars kind,
                                         const study::interval& possible)
{
    if (kind == error_bars::se)
        return t.se ? std::optional(study::interval{*t.mean - *t.se, *t.mean + *t.se}) : std::nullopt;
    const std::optional<study::interval>& i = kind == error_bars::within ? t.ci_within : t.ci;
    return i ? std::optional(study::clamp_interval(*i, possible)) : std::nullopt;
}

// Returns a panel with the means of a run's cells by motion, or nothing if the run has no cells.
std::optional<plot::bar_panel> make_panel(const study::run_analysis& r, error_bars kind)
{
    plot::bar_panel p;
    p.title = fmt::format("{} (n = {})", r.run.name, r.n);
    p.groups = r.run.motions;
    p.groups.emplace_back("all");
    p.joined = r.run.motions.size();
    for (const study::cell_means* v : study::list_values<study::cell_means>(r.results)) {
        p.y_title = v->axis;
        p.level = v->against;
        std::tie(p.y_from, p.y_to) = v->possible;
        plot::bar_series& s = p.series.emplace_back(plot::bar_series{v->method});
        for (const study::cell_mean& m : v->means)
            s.bars.push_back({*m.test.mean, find_ends(m.test, kind, v->possible), m.values});
        std::rotate(s.bars.begin(), s.bars.begin() + 1, s.bars.end()); // move "all" to the end
    }
    return p.series.empty() ? std::nullopt : std::optional(p);
}

// Returns the conditions of a run. If it has none, returns the values for all trials.
template <class Values>
std::vector<const Values*> list_conditions(const study::run_analysis& r)
{
    std::vector<const Values*> all = study::list_values<Values>(r.results);
    if (all.size() > 1)
        all.erase(all.begin());
    return all;
}

constexpr study::interval unbounded{-std::numeric_limits<double>::infinity(),
                                    std::numeric_limits<double>::infinity()};

// Returns the range that covers a bar's values and its error bar.
study::interval find_range(const plot::bar& b)
{
    std::vector<double> all = b.values;
    if (b.error)
        all.insert(all.end(), {b.error->first, b.error->second});
    const auto [low, high] = std::ranges::minmax(all);
    return {low, high};
}

// Adds a bar to a series, and extends the axis so that the bar's values fit.
void add_bar(plot::bar_panel& p, plot::bar_series& s, plot::bar b)
{
    const auto [low, high] = find_range(b);
    p.y_from = std::min(p.y_from, 1.1 * low);
    p.y_to = std::max(p.y_to, 1.1 * high);
    s.bars.push_back(std::move(b));
}

// Returns a panel with the main figure of each condition, or of all trials. Returns nothing if no participant
// has such a figure.
template <class Values>
std::optional<plot::bar_panel> make_figure_panel(const study::run_analysis& r, const std::string& axis,
                                                 error_bars kind)
{
    plot::bar_panel p{fmt::format("{} (n = {})", r.run.name, r.n), axis};
    p.level = 0.0;
    plot::bar_series s;
    bool everybody = true;
    for (const Values* v : list_conditions<Values>(r)) {
        const study::t_test& t = v->figures.front().test;
        if (!t.mean)
            continue;
        plot::bar b{*t.mean, find_ends(t, kind, unbounded)};
        for (const std::vector<std::optional<double>>& own : v->values)
            if (own.front())
                b.values.push_back(*own.front());
        everybody = everybody && b.values.size() == r.n;
        p.groups.push_back(v->condition.empty() ? "all" : v->condition);
        add_bar(p, s, std::move(b));
    }
    if (s.bars.empty())
        return {};
    p.joined = everybody ? p.groups.size() : 0; // joins by index, since each participant has a value
    p.series.push_back(std::move(s));
    return p;
}

// Returns the comparisons to draw. Without groups, leaves out comparisons of methods if the run has cells,
// because the bars of all motions already show means by method.
std::vector<const study::figure_comparison*> list_comparisons(const study::run_analysis& r)
{
    const bool cells = !study::list_values<study::cell_means>(r.results).empty();
    std::vector<const study::figure_comparison*> all =
        study::list_values<study::figure_comparison>(r.results);
    std::erase_if(all, [cells](const study::figure_comparison* v) {
        return v->all.means.front().n == 0 ||
               (v->by_group.size() < 2 && (v->levels.size() < 2 || (cells && v->factor == "method")));
    });
    return all;
}

// Returns a panel with a figure by level. If groups are compared, each group has its own bars. Only levels
// can have intervals within participants. A mean over the cells has the axis of the cells.
plot::bar_panel make_comparison_panel(const study::run_analysis& r, const study::figure_comparison& v,
                                      error_bars kind)
{
    const bool levels = v.levels.size() > 1;
    const auto cells = study::list_values<study::cell_means>(r.results);
    const study::interval possible = cells.empty() ? unbounded : cells.front()->possible;
    const quantity shown = cells.empty() ? find_quantity(r.run, v.figure) : quantity{v.figure};
    plot::bar_panel p{.title = fmt::format("{}: {} by {} (n = {})", r.run.name, shown.name,
                                           levels ? v.factor : "group", v.all.means.front().n),
                      .y_title = cells.empty() ? shown.title() : cells.front()->axis,
                      .y_to = 0.0,
                      .groups = v.levels,
                      .joined = v.levels.size()};
    for (const study::level_means& m : v.by_group.size() > 1 ? v.by_group : std::vector{v.all}) {
        plot::bar_series s{m.group};
        for (std::size_t i = 0; i < v.levels.size(); ++i)
            add_bar(p, s,
                    {*m.means[i].mean, find_ends(m.means[i], levels ? error_bars::within : kind, possible),
                     m.values[i]});
        p.series.push_back(std::move(s));
    }
    const bool is_level = v.figure == "pse" || v.figure == "threshold";
    if (!cells.empty()) {
        std::tie(p.y_from, p.y_to) = possible;
    } else if (r.run.on_db_axis && is_level && p.y_to == 0.0) { // 0 dB is not an origin: levels are far below
        double low = p.y_to;
        double high = p.y_from;
        for (const plot::bar_series& s : p.series)
            for (const plot::bar& b : s.bars) {
                low = std::min(low, find_range(b).first);
                high = std::max(high, find_range(b).second);
            }
        const double space = std::max(0.5, 0.2 * (high - low));
        p.y_from = low - space;
        p.y_to = high + space;
    }
    if (p.y_from == p.y_to)
        p.y_to = 1.0; // all values are 0
    return p;
}

// Returns the axis of the varied values. It includes the standard.
plot::curve_axis make_value_axis(const study::run_outline& r, bool logs)
{
    constexpr double space = 0.05;
    const auto place = [logs](double v) { return logs ? std::log10(v) : v; };
    plot::curve_axis x{find_varied(r).title(), place(r.values.front()), place(r.values.back())};
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

// Samples a psychometric function. The result is in per cent.
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

study::psychometric_family replace_guess(study::psychometric_family f, double guess)
{
    f.guess = guess;
    return f;
}

// Returns the psychometric function with the mean pse or threshold, and with the mean jnd.
std::optional<plot::curve> make_mean_curve(const study::psychometric_functions& v, const plot::curve_axis& x,
                                           const std::vector<plot::curve>&)
{
    std::vector<double> slopes;
    std::vector<double> guesses;
    for (const study::fitted_function& f : v.people)
        if (f.fit && !f.fit->step) {
            slopes.push_back(f.fit->parameters.slope);
            guesses.push_back(f.guess);
        }
    if (slopes.empty())
        return {};
    return plot::curve{.thick = true,
                       .line = sample_function({*v.figures.front().test.mean, study::mean(slopes)},
                                               replace_guess(v.family, study::mean(guesses)), x)};
}

// Returns the geometric means of the participants' estimates. Each mean is over the estimates at one value.
std::optional<plot::curve> make_mean_curve(const study::exponents&, const plot::curve_axis&,
                                           const std::vector<plot::curve>& people)
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

plot::curve make_curve(const study::psychometric_functions& v, const study::fitted_function& f,
                       const plot::curve_axis& x)
{
    plot::curve one;
    if (f.fit)
        one.line = sample_function(f.fit->parameters, replace_guess(v.family, f.guess), x);
    for (const study::answer_block& b : f.blocks)
        one.dots.push_back(
            {{b.x, 100.0 * static_cast<double>(b.k) / static_cast<double>(b.n)}, static_cast<double>(b.n)});
    return one;
}

plot::curve make_curve(const study::exponents&, const study::fitted_exponent& f, const plot::curve_axis& x)
{
    plot::curve one;
    for (const study::value_estimate& e : f.estimates) {
        const plot::spot at{x.logs ? std::log10(e.value) : e.value, std::log10(e.ratio)};
        one.line.push_back(at);
        one.dots.push_back({at, static_cast<double>(e.n)});
    }
    return one;
}

plot::curve_axis make_answer_axis(const std::vector<const study::psychometric_functions*>& all)
{
    constexpr double space = 0.05;
    return {all.front()->axis, -100.0 * space, 100.0 * (1.0 + space), 50.0};
}

plot::curve_axis make_answer_axis(const std::vector<const study::exponents*>& all)
{
    constexpr double space = 0.05;
    plot::curve_axis y{"estimate / participant's mean", 0.0, 0.0, {}, true};
    for (const study::exponents* v : all)
        for (const study::fitted_exponent& f : v->people)
            for (const study::value_estimate& e : f.estimates) {
                y.from = std::min(y.from, std::log10(e.ratio));
                y.to = std::max(y.to, std::log10(e.ratio));
            }
    const double width = std::max(space, y.to - y.from);
    y.from -= space * width;
    y.to += space * width;
    return y;
}

// Returns true if values are drawn as logarithms. This applies to estimates at values that are not levels.
bool has_log_axis(const study::psychometric_functions&, const study::run_outline&)
{
    return false;
}

bool has_log_axis(const study::exponents&, const study::run_outline& r)
{
    return !r.on_db_axis;
}

std::string exponent_text(const study::psychometric_functions&)
{
    return {};
}

std::string exponent_text(const study::exponents& v)
{
    const auto& exponent = v.figures.front().test.mean;
    return exponent ? fmt::format(", exponent {:.2f}", *exponent) : "";
}

// Draws a panel for each condition, with the participants' curves and their mean. If there are several
// conditions, a panel with their means comes first.
template <class Values>
void add_curves(plot::panel_figure& f, const study::run_analysis& r)
{
    const std::vector<const Values*> all = study::list_values<Values>(r.results);
    if (all.empty())
        return;
    const plot::curve_axis x = make_value_axis(r.run, has_log_axis(*all.front(), r.run));
    const plot::curve_axis y = make_answer_axis(all);
    plot::curve_panel means{fmt::format("{}: means (n = {})", r.run.name, r.n), x, y};
    std::vector<plot::curve_panel> panels;
    for (const Values* v : list_conditions<Values>(r)) {
        const std::string title =
            v->condition.empty()
                ? fmt::format("{} (n = {}{})", r.run.name, r.n, exponent_text(*v))
                : fmt::format("{} ({}, n = {}{})", v->condition, r.run.name, r.n, exponent_text(*v));
        plot::curve_panel& p = panels.emplace_back(plot::curve_panel{title, x, y});
        double most = 0.0;
        for (const auto& one : v->people) {
            p.curves.push_back(make_curve(*v, one, x));
            p.curves.back().colour = panels.size() - 1;
            for (const plot::weighted_dot& d : p.curves.back().dots)
                most = std::max(most, d.weight);
        }
        p.key = fmt::format("largest point: {}", counted(static_cast<std::uint64_t>(most), "trial"));
        std::optional<plot::curve> mean = make_mean_curve(*v, x, p.curves);
        if (!mean)
            continue;
        mean->colour = panels.size() - 1;
        if (r.n > 1)
            p.curves.push_back(*mean);
        mean->name = v->condition;
        means.curves.push_back(*std::move(mean));
    }
    if (means.curves.size() > 1)
        f.curves.push_back(std::move(means));
    f.curves.insert(f.curves.end(), panels.begin(), panels.end());
}

// Returns axes that are large enough for every drawing in a study.
std::pair<plot::curve_axis, plot::curve_axis> make_drawing_axes(const study::analysis& a)
{
    constexpr double edge_mm = 3.0;
    constexpr double far = std::numeric_limits<double>::infinity();
    std::pair<plot::curve_axis, plot::curve_axis> axes{{"x (mm)", far, -far}, {"y (mm)", far, -far}};
    const auto make_room = [&axes](const std::vector<point>& points) {
        for (const point& p : points)
            for (const auto& [axis, at] : {std::pair(&axes.first, p.x_mm), {&axes.second, p.y_mm}}) {
                axis->from = std::min(axis->from, at - edge_mm);
                axis->to = std::max(axis->to, at + edge_mm);
            }
    };
    for (const study::run_analysis& r : a.runs)
        for (const study::drawn_answers* v : study::list_values<study::drawn_answers>(r.results)) {
            if (v->target.empty())
                continue;
            make_room(v->target);
            make_room(v->mean);
            for (const study::drawn_by_person& person : v->people)
                std::ranges::for_each(person.drawings, make_room);
            for (const study::predicted_drawing& p : v->predicted)
                make_room(p.points);
        }
    return axes;
}

// Draws the places or paths of each condition to scale. The target is at the bottom, then the participants'
// drawings, and their mean on top. A dot marks the start of a path.
void add_drawings(plot::panel_figure& f, const study::run_analysis& r,
                  const std::pair<plot::curve_axis, plot::curve_axis>& axes)
{
    for (const study::drawn_answers* v : study::list_values<study::drawn_answers>(r.results)) {
        if (v->target.empty())
            continue;
        plot::curve_panel p{
            fmt::format("{} ({}, n = {})", v->condition.empty() ? r.run.name : v->condition, r.run.name, r.n),
            axes.first, axes.second};
        p.to_scale = true;
        const auto add = [&](const std::vector<point>& points, const std::string& name, std::size_t colour) {
            constexpr double large = 6.0; // curves with a name stand out from the others
            plot::curve& one = p.curves.emplace_back(plot::curve{name, colour, !name.empty()});
            for (const point& at : points)
                one.line.push_back({at.x_mm, at.y_mm});
            if (!points.empty())
                one.dots = {{one.line.front(), one.thick ? large : 1.0}};
        };
        add(v->target, "target", 1);
        for (const study::drawn_by_person& person : v->people)
            for (const std::vector<point>& drawing : person.drawings)
                add(drawing, "", 0);
        for (std::size_t i = 0; i < v->predicted.size(); ++i)
            add(v->predicted[i].points, v->predicted[i].observer + " observer", 2 + i);
        add(v->mean, "mean", 0);
        f.curves.push_back(std::move(p));
    }
}

// Draws the map of methods, in which each method is a point.
void add_maps(plot::panel_figure& f, const study::run_analysis& r)
{
    for (const study::method_map* v : study::list_values<study::method_map>(r.results)) {
        plot::curve_panel p{
            fmt::format("{}: methods (n = {}, stress {:.3f})", r.run.name, r.n, v->all.scaled.stress),
            {"first dimension"},
            {"second dimension"}};
        p.to_scale = true;
        double farthest = 1.0;
        plot::curve& all = p.curves.emplace_back();
        for (const auto& [x, y] : v->all.scaled.places)
            farthest = std::max({farthest, std::abs(x), std::abs(y)});
        for (std::size_t m = 0; m < v->methods.size(); ++m) {
            const auto& [x, y] = v->all.scaled.places[m];
            const auto same = std::ranges::find_if(all.dots, [&](const plot::weighted_dot& d) {
                return std::hypot(d.at.x - x, d.at.y - y) < 0.02 * farthest;
            });
            if (same == all.dots.end())
                all.dots.push_back({{x, y}, 1.0, v->methods[m]});
            else // both have the same point
                same->name += ", " + v->methods[m];
        }
        constexpr double space = 1.2; // space for the names
        for (plot::curve_axis* axis : {&p.x, &p.y}) {
            axis->from = -space * farthest;
            axis->to = space * farthest;
        }
        f.curves.push_back(std::move(p));
    }
}

// Returns a description of what the figure shows.
std::string describe_panels(const plot::panel_figure& f, const study::analysis& a, error_bars kind)
{
    std::vector<std::string> notes;
    if (!f.bars.empty())
        notes.push_back(
            fmt::format("Means over participants; error bars: {}; dots and thin lines: participants.",
                        all_error_bars[static_cast<std::size_t>(kind)].second));
    bool without_function = false;
    bool estimates = false;
    bool levels = false;
    bool drawings = false;
    bool maps = false;
    for (const study::run_analysis& r : a.runs) {
        if (r.n == 0)
            continue;
        for (const study::figure_comparison* v : list_comparisons(r))
            levels = levels || v->levels.size() > 1;
        drawings = drawings || !study::list_values<study::drawn_answers>(r.results).empty();
        maps = maps || !study::list_values<study::method_map>(r.results).empty();
        for (const auto* v : study::list_values<study::psychometric_functions>(r.results))
            for (const study::fitted_function& one : v->people)
                without_function = without_function || (!one.blocks.empty() && !one.fit);
        for (const auto* v : study::list_values<study::exponents>(r.results))
            for (const study::fitted_exponent& one : v->people)
                estimates = estimates || !one.estimates.empty();
    }
    if (levels && kind != error_bars::within)
        notes.push_back(fmt::format("By method or session: {}.",
                                    all_error_bars[static_cast<std::size_t>(error_bars::within)].second));
    if (drawings)
        notes.emplace_back("To scale: each drawing of each participant, their mean, the target, and "
                           "predictions; a point marks "
                           "a place, or the start of a path.");
    if (maps)
        notes.emplace_back("Methods in the plane: the more they differ, the farther apart they are.");
    if (!std::ranges::all_of(f.curves, &plot::curve_panel::to_scale))
        notes.emplace_back("Thin lines and points: participants; the area of a point grows with its trials.");
    if (std::ranges::any_of(f.curves,
                            [](const plot::curve_panel& p) { return !p.to_scale && p.curves.back().thick; }))
        notes.emplace_back("Thick: functions of the means of the participants' figures.");
    if (without_function)
        notes.emplace_back("Points without a line: answers that determine no function.");
    if (estimates)
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
    const auto drawn_axes = make_drawing_axes(a);
    for (const study::run_analysis& r : a.runs) {
        if (r.n == 0)
            continue;
        add_curves<study::psychometric_functions>(f, r);
        add_curves<study::exponents>(f, r);
        add_drawings(f, r, drawn_axes);
        add_maps(f, r);
        std::optional<plot::bar_panel> p = make_panel(r, kind);
        if (!p && r.run.vary.empty())
            p = make_figure_panel<study::sensitivities>(r, "d'", kind);
        if (!p)
            p = make_figure_panel<study::oddities>(r, "d'", kind);
        if (!p)
            p = make_figure_panel<study::adjustments>(r, find_quantity(r.run, "constant_error").title(),
                                                      kind);
        if (p)
            f.bars.push_back(*std::move(p));
        for (const study::figure_comparison* v : list_comparisons(r))
            f.bars.push_back(make_comparison_panel(r, *v, kind));
        for (const study::answer_counts* v : study::list_values<study::answer_counts>(r.results))
            if (v->motions.size() > 1)
                f.matrices.push_back({fmt::format("{}: answers with {}", r.run.name, v->method), "played",
                                      "answered", v->motions, v->counts});
    }
    f.note = describe_panels(f, a, kind);
    return plot::draw_panels(f);
}

} // namespace tactor::cli
