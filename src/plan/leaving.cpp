// SPDX-License-Identifier: MIT
#include "plan/leaving.hpp"
#include "core/access.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "core/path/shape.hpp"
#include "core/trajectory/spans.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/sides.hpp"

namespace tactor::detail {
namespace {

/// Parameters, ascending, at which a curve turns round as seen from the sides that it may cross.
void turns_seen(const shape& form, const std::vector<beyond>& sides, std::vector<double>& turns_at)
{
    turns_at.clear();
    const std::array<point, 4> frame = frame_of(form);
    for (const beyond& s : sides) {
        const bool within =
            std::all_of(frame.begin(), frame.end(), [&](point p) { return dot(s.out, p) <= s.reach; });
        if (within)
            continue;
        const std::vector<double> t = turns_towards(form, s.out);
        turns_at.insert(turns_at.end(), t.begin(), t.end());
    }
    std::sort(turns_at.begin(), turns_at.end());
}

} // namespace

void check_inside(const job& j)
{
    const std::vector<beyond> sides = sides_of(detail::access::of(j.faces));
    std::vector<double> turns_at;
    follower target(j);
    target.at(0.0);
    double latest_s = 0.0;
    const auto look = [&](double t_s) {
        latest_s = std::max(latest_s, t_s); // rounding may put the turn of a curve beside its end
        target.at(latest_s);
    };
    for_each_span(j.motion.motion, [&](const trajectory_span& span) {
        if (span.curve != nullptr) {
            turns_seen(*span.curve, sides, turns_at);
            for (const double t : turns_at)
                look(span.time_at(t));
        }
        look(span.to_s);
        return true;
    });
}

} // namespace tactor::detail
