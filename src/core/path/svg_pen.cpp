// SPDX-License-Identifier: MIT
#include "core/path/svg_pen.hpp"

#include <utility>

namespace tactor::detail {

void path_pen::draw(char command, const path_arguments& v)
{
    const char kind = upper(command);
    const point base = command == kind ? point{} : at_;
    const auto to = [&](std::size_t i) { return point{base.x_mm + v[i], base.y_mm + v[i + 1]}; };
    switch (kind) {
    case 'M':
        return move(to(0));
    case 'L':
        return line(to(0));
    case 'H':
        return line({base.x_mm + v[0], at_.y_mm});
    case 'V':
        return line({at_.x_mm, base.y_mm + v[0]});
    case 'C':
        return cubic(to(0), to(2), to(4));
    case 'S':
        return cubic(cubic_handle_, to(0), to(2));
    case 'Q':
        return quadratic(to(0), to(2));
    case 'T':
        return quadratic(quadratic_handle_, to(0));
    default:
        return arc(v, to(5));
    }
}

void path_pen::move(point to)
{
    finish();
    start_ = to;
    open_.vertices.assign(1, to);
    arrive(to);
    draws_ = false;
}

void path_pen::line(point to)
{
    open_.line(to);
    arrive(to);
}

void path_pen::cubic(point c1, point c2, point to)
{
    open_.bezier(c1, c2, to);
    arrive(to);
    cubic_handle_ = to + (to - c2);
}

void path_pen::quadratic(point c, point to)
{
    open_.quadratic(c, to);
    arrive(to);
    quadratic_handle_ = to + (to - c);
}

void path_pen::arc(const path_arguments& v, point to)
{
    if (to == at_) {
        cubic_handle_ = quadratic_handle_ = to;
        return; // no arc at all, says SVG, where a line would be one without length
    }
    if (const auto a = svg_arc(at_, v[0], v[1], v[2], v[3] != 0.0, v[4] != 0.0, to))
        open_.arc(*a, to);
    else
        open_.line(to);
    arrive(to);
}

void path_pen::close()
{
    line(start_);
    move(start_);
}

std::vector<outline> path_pen::take()
{
    finish();
    return std::exchange(drawn_, {});
}

// Every command but M draws, if only a point.
void path_pen::arrive(point to)
{
    draws_ = true;
    at_ = cubic_handle_ = quadratic_handle_ = to;
}

void path_pen::finish()
{
    if (draws_)
        drawn_.push_back(std::move(open_));
    open_ = {};
    draws_ = false;
}

} // namespace tactor::detail
