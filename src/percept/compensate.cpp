// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>

#include "core/access.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"
#include "percept/hull_fit.hpp"
#include "percept/low_speed.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/sides.hpp"
#include "plan/job.hpp"
#include "plan/missed_places.hpp"
#include "plan/options.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr double on_edge_mm = 1e-6;
// Least give: below it, sixteen digits do not distinguish a place from its neighbours'.
constexpr double least_give = 1e-7;

point mean_point(const std::vector<point>& corners)
{
    point sum;
    for (const point& p : corners)
        sum = {sum.x_mm + p.x_mm, sum.y_mm + p.y_mm};
    const double n = static_cast<double>(corners.size());
    return {sum.x_mm / n, sum.y_mm / n};
}

// Returns the limits of the array for taps: its sides, its two ends if all tactors are in one line, nothing
// for a single one.
std::vector<detail::beyond> ends_or_sides(const layout::impl& l)
{
    if (!l.hull.empty())
        return detail::hull_sides(l);
    const auto [first, last] = detail::find_ends(l.points);
    const double length = distance_mm(first, last);
    if (!(length > 0.0))
        return {};
    const point along{(last.x_mm - first.x_mm) / length, (last.y_mm - first.y_mm) / length};
    const point back{-along.x_mm, -along.y_mm};
    // The search needs a closed figure. Nothing reaches the sides across.
    const point left{-along.y_mm, along.x_mm};
    const point right{along.y_mm, -along.x_mm};
    return {{along, detail::dot(along, last)},
            {back, detail::dot(back, first)},
            {left, detail::dot(left, first) + length},
            {right, detail::dot(right, first) + length}};
}

// Moves targets onto the line of the tactors, because there is no choice across it.
std::vector<point> onto_line(const layout::impl& l, std::vector<point> targets)
{
    const auto [first, last] = detail::find_ends(l.points);
    const double length = distance_mm(first, last);
    const point along{(last.x_mm - first.x_mm) / length, (last.y_mm - first.y_mm) / length};
    for (point& p : targets) {
        const double t = detail::dot(along, {p.x_mm - first.x_mm, p.y_mm - first.y_mm});
        p = {first.x_mm + t * along.x_mm, first.y_mm + t * along.y_mm};
    }
    return targets;
}

void fit(const layout& l, std::span<const double> give, std::span<const point> targets, compensated_places& r)
{
    const layout::impl& in = detail::access::of(l);
    const std::vector<detail::beyond> sides = ends_or_sides(in);
    if (sides.empty()) {
        r.played.assign(targets.size(), in.points.front());
        r.at_edge = targets.size();
        return;
    }
    std::vector<point> x(targets.begin(), targets.end());
    if (in.hull.empty())
        x = onto_line(in, std::move(x));
    r.played = detail::fit_inside(give, x, sides, mean_point(in.hull.empty() ? in.points : in.hull));
    const auto on_edge = [&](point p) {
        return std::any_of(sides.begin(), sides.end(), [p](const detail::beyond& e) {
            return detail::dot(e.out, p) > e.reach - on_edge_mm;
        });
    };
    r.at_edge = static_cast<std::size_t>(std::count_if(r.played.begin(), r.played.end(), on_edge));
    for (point& p : r.played)
        p = l.nearest(p); // rounding
}

// Returns the notice that every command prints about a compensated plan.
std::string notice(const compensated_plan& p)
{
    if (p.taps.empty())
        return fmt::format("no burst sounds that could be moved for {}", describe(p.observer));
    const tap_summary felt = summarise(p.taps);
    std::string text = fmt::format("bursts are moved for {}; it is predicted to feel them {:.3f} mm RMS and "
                                   "at most {:.3f} mm from the target",
                                   describe(p.observer), felt.rms_error_mm.value_or(0.0),
                                   felt.largest_error_mm.value_or(0.0));
    if (p.at_edge != 0)
        text += fmt::format(
            "; {} of {} cannot be moved far enough on this array, which alone leaves {:.3f} mm RMS "
            "and at most {:.3f} mm",
            p.at_edge, counted(p.taps.size(), "burst"), p.residual_rms_mm, p.residual_largest_mm);
    if (p.plan.algorithm == to_string(algorithm_kind::tactile_brush))
        text += "; off the lines of the grid they are no longer the Tactile Brush's";
    return text;
}

// Returns the plan's warning about bursts outside the triangle of their three tactors; empty if there is
// none.
std::string missed_warning(const layout& l, const plan& p)
{
    detail::missed_places missed;
    if (p.faces == faces_kind::nearest)
        for (const burst& b : p.bursts)
            missed.add(l, b);
    return missed.warning("burst");
}

} // namespace

compensated_places compensate(const layout& l, const low_speed_observer& o, std::span<const double> onsets_s,
                              std::span<const point> targets)
{
    compensated_places r;
    static_cast<void>(felt_places(o, onsets_s, targets)); // checks the arguments
    const std::vector<double> give = detail::link_give(o, onsets_s);
    if (std::any_of(give.begin(), give.end(), [](double g) { return g < least_give; }))
        throw error(error_kind::bad_input, "compensation",
                    "bursts that begin together, or nearly so for this observer, cannot be felt apart",
                    "a smaller {sigma_mm}, a larger {sigma_v_mm_s} or a longer SOA")
            .with_field("compensate");
    r.played = detail::pushed(give, targets);
    if (!std::all_of(r.played.begin(), r.played.end(), [&](point p) { return l.contains(p); }))
        fit(l, give, targets, r);
    r.felt = detail::pulled(give, r.played);
    return r;
}

compensated_plan make_compensated_plan(const array& a, const layout& l, const stroke& s,
                                       const plan_options& o, const low_speed_observer& m)
{
    if (s.fit)
        return make_compensated_plan(a, l, apply_fits({s}, l).front(), o, m);
    const plan_options chosen = detail::chosen(o, s.choices);
    if (chosen.algorithm == algorithm_kind::continuous)
        throw detail::bad_field("algorithm",
                                "continuous has no bursts that could be moved for the low-speed observer",
                                "{algorithm=park2016}, or no compensation");
    compensated_plan r;
    r.plan = make_plan(a, l, s, o);
    r.observer = m;
    std::vector<burst*> felt;
    std::vector<double> onsets_s;
    std::vector<point> targets;
    for (burst& b : r.plan.bursts)
        if (detail::find_centre(a, b)) {
            felt.push_back(&b);
            onsets_s.push_back(b.onset_s);
            targets.push_back(s.motion.position(b.onset_s));
        }
    const compensated_places places = compensate(l, m, onsets_s, targets);
    std::erase(r.plan.warnings, missed_warning(l, r.plan)); // counted again for the moved bursts
    const std::shared_ptr<const phantom_model> model = detail::choose_model(l, chosen);
    for (std::size_t i = 0; i < felt.size(); ++i) {
        burst& b = *felt[i];
        b.position = places.played[i];
        detail::drives_at(*model, l, b.position, b.intensity, b.drives);
    }
    if (std::string text = missed_warning(l, r.plan); !text.empty())
        r.plan.warnings.push_back(std::move(text));
    r.plan.conflicts = detail::find_conflicts(r.plan.bursts);
    r.taps = predict_taps(a, s, r.plan, m);
    r.at_edge = places.at_edge;
    double squares = 0.0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const double e = distance_mm(places.felt[i], targets[i]);
        squares += e * e;
        r.residual_largest_mm = std::max(r.residual_largest_mm, e);
    }
    if (!targets.empty())
        r.residual_rms_mm = std::sqrt(squares / static_cast<double>(targets.size()));
    r.plan.warnings.push_back(notice(r));
    return r;
}

} // namespace v0
} // namespace tactor
