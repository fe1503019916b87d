// SPDX-License-Identifier: MIT
#include "cli/play/instant.hpp"

#include <algorithm>
#include <cstdint>

namespace tactor::cli {

piece_follower::piece_follower(const piece& p, const score& s, const array& a)
    : piece_(p), score_(s), faces_(a), sounding_(s)
{
}

instant piece_follower::at(double t_s)
{
    instant now{sounding_.at(static_cast<std::uint64_t>(t_s * score_.rate())), {}};
    for (std::size_t i = 0; i < std::min(piece_.strokes.size(), score_.plans().size()); ++i) {
        const double t = t_s - static_cast<double>(score_.starts()[i]) / score_.rate();
        if (t < 0.0 || t > score_.plans()[i].plan.total_s)
            continue;
        const point p = piece_.strokes[i].motion.position(t);
        now.target = faces_.contains(p) ? p : faces_.nearest(p);
        break;
    }
    return now;
}

} // namespace tactor::cli
