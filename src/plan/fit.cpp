// SPDX-License-Identifier: MIT
#include <tactor/phantom.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/refused.hpp"
#include "core/trajectory/impl.hpp"
#include "core/trajectory/spans.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/plane.hpp"
#include "plan/job.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::affine;
using detail::dot;
using detail::operator+;
using detail::operator-;
using detail::operator*;

/// Height, relative to the pitch, up to which an array counts as a line. Measured places are never exactly in
/// one line.
constexpr double thin_by_pitch = 0.1;

/// Picture that consists of all strokes.
class picture {
public:
    explicit picture(const std::vector<stroke>& strokes)
    {
        std::vector<point> all;
        for (const stroke& s : strokes)
            detail::add_outline(s.motion, all, curves_);
        corners_ = detail::convex_hull(std::move(all));
    }

    /// Returns the greatest dot(out, p) of the picture's points p.
    double reach(point out) const
    {
        double most = -std::numeric_limits<double>::infinity();
        for (const point p : corners_)
            most = std::max(most, dot(out, p));
        for (const detail::shape& c : curves_) {
            const auto frame = detail::control_frame(c);
            if (std::none_of(frame.begin(), frame.end(), [&](point p) { return dot(out, p) > most; }))
                continue;
            for (const double t : detail::find_turns_in_direction(c, out))
                most = std::max(most, dot(out, detail::position(c, t)));
        }
        return most;
    }

    double extent(point along) const { return reach(along) + reach(-1.0 * along); }
    double middle(point along) const { return 0.5 * (reach(along) - reach(-1.0 * along)); }

    bool rests() const { return extent({1.0, 0.0}) <= same_place_mm && extent({0.0, 1.0}) <= same_place_mm; }

private:
    std::vector<point> corners_; ///< corners of the convex hull
    std::vector<detail::shape> curves_;
};

point centre_of_gravity(const std::vector<point>& hull)
{
    double all = 0.0;
    point sum{};
    for (std::size_t i = 2; i < hull.size(); ++i) {
        const point b = hull[i - 1] - hull[0];
        const point c = hull[i] - hull[0];
        const double area = detail::turn({}, b, c);
        all += area;
        sum = sum + (area / 3.0) * (b + c);
    }
    return hull[0] + (1.0 / all) * sum;
}

/// Returns the direction of an array in one line; nothing for a wider array.
std::optional<point> find_line(const layout::impl& l, std::pair<point, point> ends)
{
    const double length = distance_mm(ends.first, ends.second);
    const point along = length > 0.0 ? 1.0 / length * (ends.second - ends.first) : point{1.0, 0.0};
    const point across{along.y_mm, -along.x_mm};
    double low = 0.0;
    double high = 0.0;
    for (const point p : l.hull) {
        const double off = dot(across, p - ends.first);
        low = std::min(low, off);
        high = std::max(high, off);
    }
    if (!l.hull.empty() && high - low > thin_by_pitch * l.pitch_mm)
        return std::nullopt;
    return along;
}

[[noreturn]] void refuse_margin(double margin_mm, double room_mm)
{
    throw detail::bad_field("margin_mm",
                            fmt::format("{:.6g} mm on each side leaves no space in the array", margin_mm),
                            room_mm > 0.0 ? fmt::format("use less than {:.4g} mm", room_mm)
                                          : "use 0: one tactor has no space for a margin");
}

[[noreturn]] void refuse_cross_stroke(const std::string& what)
{
    throw error(error_kind::bad_input, what, "it only goes across the line of tactors, not along it",
                "turn the stroke, or use an array with two rows");
}

/// Throws error (bad_input) if a stroke would lose its length, because people could not feel a direction.
void check_fitted_lengths(const std::vector<stroke>& strokes, const fitting& f)
{
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        const picture one({strokes[i]});
        if (one.rests() || f.scale * one.extent(*f.line) > same_place_mm)
            continue;
        const std::string& name = strokes[i].name;
        refuse_cross_stroke(name.empty() ? fmt::format("stroke {}", i) : fmt::format("stroke \"{}\"", name));
    }
}

fitting fit_to_line(const picture& drawn, const layout::impl& l, std::pair<point, point> ends, point along,
                    double margin_mm)
{
    const double length = distance_mm(ends.first, ends.second);
    fitting f{{drawn.middle({1.0, 0.0}), drawn.middle({0.0, 1.0})},
              detail::interpolate_points(ends.first, ends.second, 0.5),
              1.0,
              margin_mm,
              along};
    if (2.0 * margin_mm > length || (2.0 * margin_mm == length && margin_mm > 0.0))
        refuse_margin(margin_mm, 0.5 * length);
    if (drawn.rests())
        return f;
    if (l.points.size() == 1)
        throw error(error_kind::bad_input, "stroke", "it does not fit on a single tactor",
                    "use an array of two or more tactors");
    const double extent = drawn.extent(along);
    if (!(extent > same_place_mm))
        refuse_cross_stroke("stroke");
    f.from = f.from + (drawn.middle(along) - dot(along, f.from)) * along;
    f.scale = (length - 2.0 * margin_mm) / extent;
    return f;
}

fitting fit_to_hull(const picture& drawn, const layout::impl& l, double margin_mm)
{
    fitting f{{drawn.middle({1.0, 0.0}), drawn.middle({0.0, 1.0})},
              centre_of_gravity(l.hull),
              std::numeric_limits<double>::infinity(),
              margin_mm,
              {}};
    const bool rests = drawn.rests();
    double narrowest = std::numeric_limits<double>::infinity();
    for (const detail::hull_side& side : detail::hull_sides(l)) {
        const double space = side.reach - dot(side.out, f.to);
        narrowest = std::min(narrowest, space);
        const double reach = rests ? 0.0 : drawn.reach(side.out) - dot(side.out, f.from);
        if (reach > 0.0)
            f.scale = std::min(f.scale, (space - margin_mm) / reach);
    }
    if (margin_mm >= narrowest)
        refuse_margin(margin_mm, narrowest);
    if (rests)
        f.scale = 1.0;
    return f;
}

fitting find_fit(const picture& drawn, const layout::impl& l, double margin_mm)
{
    const auto ends = detail::find_ends(l.points);
    if (const auto along = find_line(l, ends))
        return fit_to_line(drawn, l, ends, *along, margin_mm);
    return fit_to_hull(drawn, l, margin_mm);
}

/// Returns the fitting as a map of places relative to `from`.
affine make_map(const fitting& f)
{
    const point d = f.line.value_or(point{});
    if (f.line)
        return {f.scale * d.x_mm * d.x_mm,
                f.scale * d.x_mm * d.y_mm,
                f.scale * d.x_mm * d.y_mm,
                f.scale * d.y_mm * d.y_mm,
                f.to.x_mm,
                f.to.y_mm};
    return {f.scale, 0.0, 0.0, f.scale, f.to.x_mm, f.to.y_mm};
}

/// Maps the unit square to the box around the tactors, and points outside the hull to the edge of the hull.
trajectory map_to_array(const layout& l, const trajectory& t)
{
    point low = l.places().front();
    point high = low;
    for (const point p : l.places()) {
        low = {std::min(low.x_mm, p.x_mm), std::min(low.y_mm, p.y_mm)};
        high = {std::max(high.x_mm, p.x_mm), std::max(high.y_mm, p.y_mm)};
    }
    std::vector<timed_point> points = detail::sample_points(t);
    for (timed_point& p : points)
        p.position = detail::clamp_to_array(l, {std::lerp(low.x_mm, high.x_mm, p.position.x_mm),
                                                std::lerp(low.y_mm, high.y_mm, p.position.y_mm)});
    return trajectory::timed(std::move(points));
}

} // namespace

fitted_strokes fit_strokes(const std::vector<stroke>& strokes, const layout& l, double margin_mm)
{
    if (!(margin_mm >= 0.0 && std::isfinite(margin_mm)))
        throw detail::bad_field("margin_mm", fmt::format("{} mm", margin_mm), "give 0 mm or more");
    fitted_strokes all{strokes, {}};
    if (strokes.empty())
        return all;
    all.placed = find_fit(picture(strokes), detail::access::of(l), margin_mm);
    if (all.placed.line)
        check_fitted_lengths(strokes, all.placed);
    const affine map = make_map(all.placed);
    for (stroke& s : all.strokes) {
        s.motion = detail::map_trajectory(s.motion, all.placed.from, map, all.placed.line,
                                          fmt::format("stroke \"{}\" as fitted", s.name));
        if (s.speed_mm_s)
            s.motion = s.motion.with_speed(*s.speed_mm_s);
    }
    return all;
}

std::vector<stroke> apply_fits(std::vector<stroke> strokes, const layout& l)
{
    std::map<std::pair<unsigned, std::size_t>, std::vector<std::size_t>>
        pictures; // strokes of group 0 are pictures by themselves
    for (std::size_t i = 0; i < strokes.size(); ++i)
        if (const auto& fit = strokes[i].fit; fit && fit->unit_square) {
            strokes[i].motion = map_to_array(l, strokes[i].motion);
            strokes[i].fit.reset();
        } else if (fit)
            pictures[{fit->group, fit->group == 0 ? i : 0}].push_back(i);
    for (const auto& [group, members] : pictures) {
        std::vector<stroke> together;
        for (const std::size_t i : members)
            together.push_back(strokes[i]);
        fitted_strokes fitted = fit_strokes(together, l, strokes[members.front()].fit->margin_mm);
        for (std::size_t k = 0; k < members.size(); ++k) {
            stroke& s = strokes[members[k]] = std::move(fitted.strokes[k]);
            s.fit.reset();
        }
    }
    return strokes;
}

} // namespace v0
} // namespace tactor
