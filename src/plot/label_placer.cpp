// SPDX-License-Identifier: MIT
#include "plot/label_placer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plot/text.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_obstacles = 4000; // what a crowded picture has more changes no place
constexpr double off_page = 50.0;            // weight of what leaves the area
constexpr double label_weight = 20.0;

// Directions in order of preference: below, right, left, above, then the corners; y down.
struct direction {
    double x;
    double y;
};
constexpr std::array<direction, 8> directions{
    {{0, 1}, {1, 0}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
constexpr std::array<double, 4> farther{0.0, 3.0, 7.0, 12.0};

double overlap_area(box a, box b) noexcept
{
    const double w = std::min(a.right(), b.right()) - std::max(a.x, b.x);
    const double h = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
    return w > 0.0 && h > 0.0 ? w * h : 0.0;
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
    double sum = off_page * (b.width * b.height - overlap_area(b, area_));
    for (const obstacle& o : taken_)
        sum += o.weight * overlap_area(b, o.b);
    return sum;
}

spot label_placer::place(std::string_view text, double size, spot at, double gap)
{
    const double w = text_width(text, size);
    const double h = cap_height(size);
    constexpr double air = 0.8;
    box best;
    double least = std::numeric_limits<double>::infinity();
    double preference = 0.0;
    for (const double more : farther)
        for (const direction& d : directions) {
            const double corner = d.x != 0.0 && d.y != 0.0 ? 0.72 : 1.0;
            const double away = (gap + more) * corner;
            const box b{at.x + d.x * (away + w / 2.0) - w / 2.0 - air,
                        at.y + d.y * (away + h / 2.0) - h / 2.0 - air, w + 2.0 * air, h + 2.0 * air};
            const double c = cost(b) + preference;
            preference += 0.2;
            if (c < least) {
                least = c;
                best = b;
            }
        }
    block(best, label_weight);
    return {best.x + air, best.bottom() - air};
}

} // namespace tactor::plot
