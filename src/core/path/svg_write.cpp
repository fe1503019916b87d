// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

#include "core/path/impl.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using out = std::back_insert_iterator<std::string>;

void write(out o, const detail::cubic& c, point to)
{
    fmt::format_to(o, " C {} {} {} {} {} {}", c.p[1].x_mm, c.p[1].y_mm, c.p[2].x_mm, c.p[2].y_mm, to.x_mm,
                   to.y_mm);
}

constexpr double flat_mm = 1e-6; // less would be lost in the digits of coordinates of up to a kilometre

// Writes an ellipse that is so flat that it moves to and fro on a line: writes the ends that it reaches.
void write_flat(out o, const detail::elliptic& e, double turn, point to)
{
    const double end = e.from + e.sweep;
    const double low = std::min(e.from, end);
    const double high = std::max(e.from, end);
    const auto first = static_cast<int>(std::ceil((low - turn) / std::numbers::pi));
    const auto last = static_cast<int>(std::floor((high - turn) / std::numbers::pi));
    for (int n = 0; n <= last - first; ++n) {
        const double t = turn + std::numbers::pi * (e.sweep > 0.0 ? first + n : last - n);
        const point p = detail::position(e, (t - e.from) / e.sweep);
        fmt::format_to(o, " L {} {}", p.x_mm, p.y_mm);
    }
    fmt::format_to(o, " L {} {}", to.x_mm, to.y_mm);
}

// Computes the principal axes from the conjugate radii: eigenvalues of u u' + v v'. Writes parts under a half
// turn, so that no reader has to guess the centre.
void write(out o, const detail::elliptic& e, point to)
{
    const double xx = e.u.x_mm * e.u.x_mm + e.v.x_mm * e.v.x_mm;
    const double xy = e.u.x_mm * e.u.y_mm + e.v.x_mm * e.v.y_mm;
    const double yy = e.u.y_mm * e.u.y_mm + e.v.y_mm * e.v.y_mm;
    const double determinant = e.u.x_mm * e.v.y_mm - e.u.y_mm * e.v.x_mm;
    const double longer = std::sqrt(0.5 * (xx + yy + std::hypot(xx - yy, 2.0 * xy)));
    const double shorter = std::abs(determinant) / longer;
    if (shorter < flat_mm) {
        const double uu = e.u.x_mm * e.u.x_mm + e.u.y_mm * e.u.y_mm;
        const double uv = e.u.x_mm * e.v.x_mm + e.u.y_mm * e.v.y_mm;
        const double vv = e.v.x_mm * e.v.x_mm + e.v.y_mm * e.v.y_mm;
        return write_flat(o, e, 0.5 * std::atan2(2.0 * uv, uu - vv), to);
    }
    const double turn = 0.5 * std::atan2(2.0 * xy, xx - yy) * 180.0 / std::numbers::pi;
    const bool clockwise = (determinant > 0.0) == (e.sweep > 0.0);
    const int parts = static_cast<int>(std::ceil(std::abs(e.sweep) / 2.1));
    for (int k = 1; k <= parts; ++k) {
        const point p = k == parts ? to : detail::position(e, static_cast<double>(k) / parts);
        fmt::format_to(o, " A {} {} {} 0 {} {} {}", longer, shorter, turn, clockwise ? 1 : 0, p.x_mm, p.y_mm);
    }
}

} // namespace

std::string path::svg() const
{
    const impl& p = *impl_;
    std::string data = fmt::format("M {} {}", p.vertices[0].x_mm, p.vertices[0].y_mm);
    const out o(data);
    auto curve = p.curves.begin();
    for (std::size_t i = 0; i + 1 < p.vertices.size(); ++i) {
        const point to = p.vertices[i + 1];
        if (curve != p.curves.end() && curve->segment == i)
            std::visit([&](const auto& form) { write(o, form, to); }, (curve++)->form);
        else
            fmt::format_to(o, " L {} {}", to.x_mm, to.y_mm);
    }
    return data;
}

} // namespace v0
} // namespace tactor
