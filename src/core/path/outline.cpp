// SPDX-License-Identifier: MIT
#include "core/path/outline.hpp"

#include <cmath>

#include "core/limits.hpp"

namespace tactor::detail {
namespace {

std::optional<double> absurd(point p)
{
    for (const double v : {p.x_mm, p.y_mm})
        if (!(std::abs(v) <= max_mm))
            return v;
    return std::nullopt;
}

std::optional<double> absurd(const shape& c)
{
    if (const auto* b = std::get_if<cubic>(&c)) {
        for (const point p : b->p)
            if (const auto bad = absurd(p))
                return bad;
        return std::nullopt;
    }
    const auto& e = std::get<elliptic>(c);
    for (const double v : {e.centre.x_mm, e.centre.y_mm, e.u.x_mm, e.u.y_mm, e.v.x_mm, e.v.y_mm, e.sweep})
        if (!std::isfinite(v))
            return v;
    for (const axis a : {axis::x, axis::y}) {
        for (const double t : turns(c, a))
            if (const auto bad = absurd(position(c, t)))
                return bad;
    }
    return std::nullopt;
}

} // namespace

void outline::line(point to)
{
    if (to != vertices.back())
        vertices.push_back(to);
}

void outline::bezier(point c1, point c2, point to)
{
    const point from = vertices.back();
    if (c1 == from && c2 == from && to == from)
        return;
    curves.push_back({vertices.size() - 1, cubic{{from, c1, c2, to}}});
    vertices.push_back(to);
}

void outline::quadratic(point c, point to)
{
    const point from = vertices.back();
    bezier(between(from, c, 2.0 / 3.0), between(to, c, 2.0 / 3.0), to);
}

void outline::arc(const elliptic& a, point to)
{
    if (a.sweep == 0.0)
        return line(to);
    curves.push_back({vertices.size() - 1, a});
    vertices.push_back(to);
}

outline mapped(outline o, const affine& m)
{
    for (point& p : o.vertices)
        p = m(p);
    for (outline::curve& c : o.curves)
        c.form = mapped(c.form, m);
    return o;
}

std::optional<double> absurd_coordinate(const outline& o)
{
    for (const point p : o.vertices)
        if (const auto bad = absurd(p))
            return bad;
    for (const outline::curve& c : o.curves)
        if (const auto bad = absurd(c.form))
            return bad;
    return std::nullopt;
}

} // namespace tactor::detail
