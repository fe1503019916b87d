// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>

#include "plot/draw/axes.hpp"

namespace tactor::plot {
namespace {

struct segment {
    spot from;
    spot to;
};

// Liang and Barsky: the part of a segment inside a box.
std::optional<segment> clip_segment(spot a, spot b, box w)
{
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    double enter = 0.0;
    double leave = 1.0;
    const auto cut = [&](double speed, double space) { // speed * t <= space
        if (speed == 0.0)
            return space >= 0.0;
        const double t = space / speed;
        if (speed < 0.0)
            enter = std::max(enter, t);
        else
            leave = std::min(leave, t);
        return enter <= leave;
    };
    if (!cut(-dx, a.x - w.x) || !cut(dx, w.right() - a.x) || !cut(-dy, a.y - w.y) ||
        !cut(dy, w.bottom() - a.y))
        return {};
    return segment{{a.x + enter * dx, a.y + enter * dy}, {a.x + leave * dx, a.y + leave * dy}};
}

bool finite(spot s) noexcept
{
    return std::isfinite(s.x) && std::isfinite(s.y);
}

} // namespace

double distance(spot p, spot a, spot b) noexcept
{
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double square = dx * dx + dy * dy;
    const double t =
        square > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
    return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

std::vector<std::vector<spot>> clip(const std::vector<spot>& line, box b)
{
    std::vector<std::vector<spot>> parts;
    bool joined = false;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const auto inside =
            finite(line[i - 1]) && finite(line[i]) ? clip_segment(line[i - 1], line[i], b) : std::nullopt;
        if (!inside) {
            joined = false;
            continue;
        }
        if (!joined)
            parts.push_back({inside->from});
        parts.back().push_back(inside->to);
        joined = inside->to.x == line[i].x && inside->to.y == line[i].y;
    }
    return parts;
}

std::vector<spot> simplify(const std::vector<spot>& line, double tolerance)
{
    if (line.size() < 3)
        return line;
    std::vector<bool> keep(line.size(), false);
    keep.front() = keep.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, line.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        double worst = tolerance;
        std::size_t at = 0;
        for (std::size_t i = first + 1; i < last; ++i) {
            const double d = distance(line[i], line[first], line[last]);
            if (d > worst) {
                worst = d;
                at = i;
            }
        }
        if (at != 0) {
            keep[at] = true;
            open.emplace_back(first, at);
            open.emplace_back(at, last);
        }
    }
    std::vector<spot> out;
    for (std::size_t i = 0; i < line.size(); ++i)
        if (keep[i])
            out.push_back(line[i]);
    return out;
}

} // namespace tactor::plot
