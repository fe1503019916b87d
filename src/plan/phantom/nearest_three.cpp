// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/access.hpp"
#include "plan/faces/face_rules.hpp"
#include "plan/faces/plane.hpp"
#include "plan/phantom/phantom_models.hpp"

namespace tactor::detail {
namespace {

/// Returns the ranks of all tactors that may be among the three closest to p, ascending; `first_mm` is the
/// distance of the closest one.
std::vector<unsigned> closest_ones(const layout::impl& l, point p, double first_mm)
{
    std::vector<unsigned> ranks;
    for (double reach = 2.0 * first_mm;; reach *= 2.0) {
        l.tactor_index.near(p, reach + 3.0 * same_place_mm, ranks);
        const auto within = [&](unsigned v) { return length_mm(p, l.points[v]) <= reach; };
        if (std::count_if(ranks.begin(), ranks.end(), within) >= 3)
            return ranks;
    }
}

/// Takes the closest of the tactors out of `ranks`, of ties the lowest rank; they are ascending.
unsigned take_closest(const layout::impl& l, point p, std::vector<unsigned>& ranks)
{
    double least = std::numeric_limits<double>::infinity();
    for (const unsigned v : ranks)
        least = std::min(least, length_mm(p, l.points[v]));
    const auto found = std::find_if(ranks.begin(), ranks.end(), [&](unsigned v) {
        return length_mm(p, l.points[v]) <= least + same_place_mm;
    });
    const unsigned rank = *found;
    ranks.erase(found);
    return rank;
}

/// Returns the three tactors closest to p, which is on none, in this order.
near_triple closest_three(const layout::impl& l, point p, double first_mm)
{
    std::vector<unsigned> near = closest_ones(l, p, first_mm);
    near_triple three{};
    for (std::size_t i = 0; i < 3; ++i) {
        three.tactors[i] = take_closest(l, p, near);
        three.distances[i] = length_mm(p, l.points[three.tactors[i]]);
    }
    return three;
}

/// Returns the side of the triangle that p is on, as places in it: the shortest, then the one of lowest
/// ranks.
std::optional<std::pair<std::size_t, std::size_t>> side_at(const layout::impl& l, const near_triple& three,
                                                           point p)
{
    std::optional<std::pair<std::size_t, std::size_t>> best;
    double shortest = 0.0;
    rank_pair ends;
    for (const auto& [i, k] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
        const point a = l.points[three.tactors[i]];
        const point b = l.points[three.tactors[k]];
        if (segment_distance_mm(a, b, p) > same_place_mm)
            continue;
        const double length = length_mm(a, b);
        const rank_pair these = std::minmax(three.tactors[i], three.tactors[k]);
        if (!best || length < shortest - same_place_mm ||
            (length <= shortest + same_place_mm && these < ends)) {
            best.emplace(i, k);
            shortest = length;
            ends = these;
        }
    }
    return best;
}

/// The rule of Park et al. 2016 as it is written: the three closest of all tactors, wherever their triangle
/// lies.
class nearest_three final : public phantom_model {
public:
    explicit nearest_three(const layout& l) : layout_(l) {}

    std::string_view name() const noexcept override { return to_string(phantom_kind::inverse_distance); }

    void weights(point asked, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, asked, a_v);
        const layout::impl& l = access::of(layout_);
        const unsigned first = l.nearest_tactor(p);
        const double first_mm = length_mm(p, l.points[first]);
        if (first_mm <= same_place_mm) {
            add_drive(layout_, first, a_v, out);
            return;
        }
        const near_triple three = closest_three(l, p, first_mm);
        const auto& d = three.distances;
        if (const auto side = side_at(l, three, p)) {
            const std::array<double, 2> a = share_of_two(d[side->first], d[side->second], a_v);
            add_drive(layout_, three.tactors[side->first], a[0], out);
            add_drive(layout_, three.tactors[side->second], a[1], out);
        } else {
            const std::array<double, 3> a = share_of_three(d, a_v);
            for (std::size_t i = 0; i < 3; ++i)
                add_drive(layout_, three.tactors[i], a[i], out);
        }
        sort_drives(out);
    }

private:
    layout layout_;
};

} // namespace

std::shared_ptr<const phantom_model> make_nearest_three(const layout& l)
{
    // In one line there are segments, and no three.
    if (l.faces().empty())
        return make_inverse_distance(l);
    return std::make_shared<nearest_three>(l);
}

} // namespace tactor::detail
