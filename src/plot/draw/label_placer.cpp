// SPDX-License-Identifier: MIT
#include "plot/draw/label_placer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_obstacles = 4000; // more do not change the places in a crowded picture
constexpr double refused = 1e6; // cost of a place for a label on a tactor, on a label or off the page

// Directions in order of preference: below, right, left, above, then the corners; y down.
struct direction {
    double x;
    double y;
};
constexpr std::array<direction, 8> directions{
    {{0, 1}, {1, 0}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
constexpr double farther = 1.5;  // pt, from ring to ring of places
constexpr double clearly = 1.25; // nearer than any other by this factor

double overlap_area(box a, box b) noexcept
{
    const double w = std::min(a.right(), b.right()) - std::max(a.x, b.x);
    const double h = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
    return w > 0.0 && h > 0.0 ? w * h : 0.0;
}

double distance(box b, spot s) noexcept
{
    return std::hypot(std::max({b.x - s.x, s.x - b.right(), 0.0}),
                      std::max({b.y - s.y, s.y - b.bottom(), 0.0}));
}

} // namespace

void label_placer::block_disc(spot centre, double radius, double weight)
{
    block({centre.x - radius, centre.y - radius, 2.0 * radius, 2.0 * radius}, weight);
}

void label_placer::block_line(const std::vector<spot>& line, double width, double weight)
{
    const double step = std::max(2.0, width);
    for (std::size_t i = 1; i < line.size() && taken_.size() < most_obstacles; ++i) {
        const spot a = line[i - 1];
        const spot b = line[i];
        const auto n = static_cast<int>(std::min(std::hypot(b.x - a.x, b.y - a.y) / step, 200.0)) + 1;
        for (int k = 0; k < n; ++k) {
            const double t = (k + 0.5) / n;
            block_disc({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}, step / 2.0, weight);
        }
    }
}

double label_placer::cost(box b) const
{
    double sum = forbidden * (b.width * b.height - overlap_area(b, area_));
    for (const obstacle& o : taken_)
        sum += o.weight * overlap_area(b, o.b);
    return sum;
}

std::optional<spot> label_placer::place(std::string_view text, double size, const std::vector<spot>& sites,
                                        std::size_t own, double gap, double reach)
{
    const double w = text_width(text, size);
    const double h = cap_height(size);
    constexpr double air = 0.8;
    const spot at = sites[own];
    const auto nearest_own = [&](box b) {
        const double near = clearly * distance(b, at);
        for (std::size_t i = 0; i < sites.size(); ++i)
            if (i != own && distance(b, sites[i]) <= near)
                return false;
        return true;
    };
    std::optional<box> best;
    double least = refused;
    double preference = 0.0;
    for (double more = 0.0; more <= reach; more += farther)
        for (const direction& d : directions) {
            const double away = (gap + more) * (d.x != 0.0 && d.y != 0.0 ? 0.72 : 1.0);
            const box b{at.x + d.x * (away + w / 2.0) - w / 2.0 - air,
                        at.y + d.y * (away + h / 2.0) - h / 2.0 - air, w + 2.0 * air, h + 2.0 * air};
            const double c = cost(b) + preference;
            preference += 0.2;
            if (c < least && nearest_own(b)) {
                least = c;
                best = b;
            }
        }
    if (!best)
        return std::nullopt;
    block(*best, forbidden);
    return spot{best->x + air, best->bottom() - air};
}

} // namespace tactor::plot
