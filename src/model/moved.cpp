// SPDX-License-Identifier: MIT
#include "model/moved.hpp"

#include <utility>
#include <variant>

#include "model/path_impl.hpp"
#include "model/path_outline.hpp"
#include "model/trajectory_impl.hpp"

namespace tactor::detail {
namespace {

outline outline_of(const path::impl& p)
{
    outline o;
    o.vertices = p.vertices;
    o.curves.reserve(p.curves.size());
    for (const path::impl::measured_curve& c : p.curves)
        o.curves.push_back({c.segment, c.form});
    return o;
}

// Straight pieces only, which turn where the curves do as seen along a line.
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
    if (const auto* c = std::get_if<constant_speed>(&t.data().law)) {
        const path::impl& way = c->way.data();
        corners.insert(corners.end(), way.vertices.begin(), way.vertices.end());
        for (const path::impl::measured_curve& m : way.curves)
            curves.push_back(m.form);
        return;
    }
    for (const timed_point& p : *std::get<timed_points>(t.data().law).points)
        corners.push_back(p.position);
}

trajectory moved(const trajectory& t, point from, const affine& m, std::optional<point> line,
                 const std::function<std::string()>& what)
{
    const affine to_origin{1.0, 0.0, 0.0, 1.0, -from.x_mm, -from.y_mm};
    const trajectory::impl& d = t.data();
    if (const auto* c = std::get_if<constant_speed>(&d.law)) {
        outline o = mapped(outline_of(c->way.data()), to_origin);
        if (line)
            o = with_straight_pieces(o, *line);
        return trajectory::along(make_path(mapped(std::move(o), m), what), d.duration_s, c->intensity)
            .with_intensity(d.gain);
    }
    std::vector<timed_point> points = *std::get<timed_points>(d.law).points;
    for (timed_point& p : points)
        p.position = m(to_origin(p.position));
    return trajectory::timed(std::move(points)).with_duration(d.duration_s).with_intensity(d.gain);
}

} // namespace tactor::detail
