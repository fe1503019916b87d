// SPDX-License-Identifier: MIT
#include "plan/faces/same_tactors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/access.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

// Number of places to skip after a place without a disc: the neighbours mostly have no disc, either.
constexpr unsigned most_skips = 16;

/// Returns the distance, mm, by which p may move along the segment `on` before it comes near another segment.
/// Returns 0 or less if p may not move. p must be on `on`, and on no other segment of `faces`, which contain
/// p.
double segment_clearance_mm(const layout::impl& l, const std::vector<unsigned>& faces, rank_pair on, point p)
{
    double least = std::numeric_limits<double>::infinity();
    for (const unsigned face : faces) {
        const std::vector<unsigned>& ring = l.faces[face];
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const point a = l.points[ring[i]];
            least = std::min(least, length_mm(p, a));
            for (std::size_t k = 0; k < i; ++k)
                if (rank_pair(std::minmax(ring[i], ring[k])) != on)
                    least = std::min(least, segment_distance_mm(a, l.points[ring[k]], p));
        }
    }
    // Subtracts the tolerances of the other segments and of the segment `on`.
    return (least - 3.0 * same_place_mm - l.clear_mm) * (1.0 - 1e-9);
}

// Fills in the three or two tactors that the model uses at p, and the region in which it uses these tactors.
void fill_same_tactors(const model_of_three& m, const layout::impl& l, point p, same_tactors& seen)
{
    seen.count = 3;
    seen.on_segment = false;
    seen.radius_mm = std::max(m.find_disc_tactors(p, seen.ranks), 0.0);
    if (seen.radius_mm > 0.0)
        return;
    std::vector<unsigned> faces;
    l.find_faces_at(p, faces);
    const auto on = tactor_at(l, faces, p) ? std::nullopt : segment_at(l, faces, p);
    if (!on)
        return;
    seen.on_segment = true;
    seen.count = m.find_segment_tactors(faces, *on, p, seen.ranks);
    seen.radius_mm = seen.count > 0 ? std::max(segment_clearance_mm(l, faces, *on, p), 0.0) : 0.0;
    seen.ends = {l.points[on->first], l.points[on->second]};
}

} // namespace

void compute_same_drives(const model_of_three& m, const layout& l, const same_tactors& seen, point p,
                         double a_v, std::vector<drive>& out)
{
    out.clear();
    const std::array<double, 3> amplitudes = m.amplitudes(seen.ranks, seen.count, p, a_v);
    for (std::size_t k = 0; k < seen.count; ++k) {
        const std::uint8_t i = seen.by_index[k];
        if (amplitudes[i] > 0.0)
            out.push_back({access::of(l).index_of[seen.ranks[i]], amplitudes[i]});
    }
}

void update_same_tactors(const model_of_three& m, const layout& l, point p, same_tactors& seen)
{
    if (seen.skips > 0) {
        --seen.skips;
        return;
    }
    const layout::impl& in = access::of(l);
    seen.centre = p;
    fill_same_tactors(m, in, p, seen);
    if (seen.radius_mm == 0.0) {
        seen.skips = most_skips;
        return;
    }
    seen.by_index = {0, 1, 2};
    std::sort(seen.by_index.begin(), seen.by_index.begin() + seen.count, [&](std::uint8_t a, std::uint8_t b) {
        return in.index_of[seen.ranks[a]] < in.index_of[seen.ranks[b]];
    });
}

double face_clearance_mm(const layout::impl& l, unsigned face, point p, bool by_distance)
{
    const std::vector<unsigned>& ring = l.faces[face];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const point a = l.points[ring[i]];
        const double far = length_mm(p, a);
        for (std::size_t k = 0; k < i; ++k) {
            const point b = l.points[ring[k]];
            least = std::min(least, std::abs(turn(a, b, p)) / length_mm(a, b) - l.clear_mm);
            // Both distances change by at most the distance moved.
            if (by_distance)
                least = std::min(least, 0.5 * (std::abs(far - length_mm(p, b)) - same_place_mm) - l.clear_mm);
        }
    }
    return least * (1.0 - 1e-9); // margin for the rounding of these distances
}
} // namespace tactor::detail
