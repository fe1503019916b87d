// SPDX-License-Identifier: MIT
#include "plan/phantom/same_tactors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/access.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

// On a border, where no disc is, the neighbours mostly have none either.
constexpr unsigned not_asked = 16;

} // namespace

void drives_of_three(const model_of_three& m, const layout& l, const same_tactors& seen, point p, double a_v,
                     std::vector<drive>& out)
{
    const std::array<double, 3> a = m.amplitudes(seen.three, p, a_v);
    const std::vector<unsigned>& index_of = access::of(l).index_of;
    out.clear();
    for (const std::uint8_t i : seen.by_index)
        if (a[i] > 0.0)
            out.push_back({index_of[seen.three[i]], a[i]});
}

void look_around(const model_of_three& m, const layout& l, point p, same_tactors& seen)
{
    if (seen.in_vain > 0) {
        --seen.in_vain;
        return;
    }
    seen.centre = p;
    seen.radius_mm = std::max(m.three_around(p, seen.three), 0.0);
    if (seen.radius_mm == 0.0) {
        seen.in_vain = not_asked;
        return;
    }
    const std::vector<unsigned>& index_of = access::of(l).index_of;
    seen.by_index = {0, 1, 2};
    std::sort(seen.by_index.begin(), seen.by_index.end(), [&](std::uint8_t a, std::uint8_t b) {
        return index_of[seen.three[a]] < index_of[seen.three[b]];
    });
}

double free_mm(const layout::impl& l, unsigned face, point p, bool by_distance)
{
    const std::vector<unsigned>& ring = l.faces[face];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const point a = l.points[ring[i]];
        const double far = length_mm(p, a);
        for (std::size_t k = 0; k < i; ++k) {
            const point b = l.points[ring[k]];
            least = std::min(least, std::abs(turn(a, b, p)) / length_mm(a, b) - l.clear_mm);
            // Both distances change by no more than the way.
            if (by_distance)
                least = std::min(least, 0.5 * (std::abs(far - length_mm(p, b)) - same_place_mm) - l.clear_mm);
        }
    }
    return least * (1.0 - 1e-9); // for the rounding of these distances
}

} // namespace tactor::detail
