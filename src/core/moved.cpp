// SPDX-License-Identifier: MIT
#include "core/moved.hpp"
#include "core/access.hpp"

#include <memory>
#include <utility>
#include <variant>

#include "core/path/impl.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

outline make_outline(const path::impl& p)
{
    outline o;
    o.vertices = p.vertices;
    o.curves.reserve(p.curves.size());
    for (const path::impl::measured_curve& c : p.curves)
        o.curves.push_back({c.segment, c.form});
    return o;
}

// Returns straight pieces only. They turn where the curves turn along the direction `line`.
outline with_straight_pieces(const outline& o, point line)
{
    const affine along_is_x{line.x_mm, -line.y_mm, line.y_mm, line.x_mm, 0.0, 0.0};
    outline straight;
    straight.vertices.push_back(o.vertices.front());
    auto curve = o.curves.begin();
    for (std::size_t i = 0; i + 1 < o.vertices.size(); ++i) {
        if (curve != o.curves.end() && curve->segment == i) {
            for (const double t : turns(mapped(curve->form, along_is_x), axis::x))
                straight.line(position(curve->form, t));
            ++curve;
        }
        straight.line(o.vertices[i + 1]);
    }
    return straight;
}

} // namespace

void add_outline(const trajectory& t, std::vector<point>& corners, std::vector<shape>& curves)
{
    if (const auto* c = std::get_if<drawn_path>(&access::of(t).law)) {
        const path::impl& way = access::of(c->way);
        corners.insert(corners.end(), way.vertices.begin(), way.vertices.end());
        for (const path::impl::measured_curve& m : way.curves)
            curves.push_back(m.form);
        return;
    }
    for (const timed_point& p : *std::get<timed_points>(access::of(t).law).points)
        corners.push_back(p.position);
}

trajectory moved(const trajectory& t, point from, const affine& m, std::optional<point> line,
                 std::string_view what)
{
    const affine to_origin = translation({-from.x_mm, -from.y_mm});
    const trajectory::impl& d = access::of(t);
    if (const auto* c = std::get_if<drawn_path>(&d.law)) {
        outline o = mapped(make_outline(access::of(c->way)), to_origin);
        if (line)
            o = with_straight_pieces(o, *line);
        drawn_path there{make_path(mapped(std::move(o), m), what), c->intensity, c->moves};
        return access::make<trajectory>(std::make_shared<const trajectory::impl>(
            trajectory::impl{std::move(there), d.duration_s, d.gain}));
    }
    std::vector<timed_point> points = *std::get<timed_points>(d.law).points;
    for (timed_point& p : points)
        p.position = m(to_origin(p.position));
    return scaled(trajectory::timed(std::move(points)).with_duration(d.duration_s), d.gain);
}

} // namespace tactor::detail
