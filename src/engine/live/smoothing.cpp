// SPDX-License-Identifier: MIT
#include "engine/live/live_stroke.hpp"

#include <algorithm>

namespace tactor::engine {

void smoothing::to(std::uint64_t frame, const place& p)
{
    if (!given_.empty() && given_.back().from == frame)
        given_.back().where = p;
    else
        given_.push_back({frame, p});
    // Keeps the newest place that is older than the window, and drops older ones.
    const auto counts = std::find_if(given_.begin() + 1, given_.end(),
                                     [&](const given& g) { return g.from + window_ > frame; });
    given_.erase(given_.begin(), counts - 1);
}

smoothing::place smoothing::at(std::uint64_t frame) const
{
    place mean{{0.0, 0.0}, 0.0};
    point silent{0.0, 0.0};
    double touched = 0.0; // touched part of the window
    std::uint64_t left = window_;
    std::uint64_t end = frame;
    for (auto g = given_.rbegin(); g != given_.rend() && left != 0; ++g) {
        const bool oldest = g + 1 == given_.rend();
        const std::uint64_t n = oldest ? left : std::min(left, end - std::min(end, g->from));
        const double part = static_cast<double>(n) / static_cast<double>(window_);
        point& sum = g->where.intensity > 0.0 ? mean.at : silent;
        sum.x_mm += part * g->where.at.x_mm;
        sum.y_mm += part * g->where.at.y_mm;
        touched += g->where.intensity > 0.0 ? part : 0.0;
        mean.intensity += part * g->where.intensity;
        left -= n;
        end = g->from;
    }
    if (touched == 0.0)
        return {silent, mean.intensity};
    mean.at.x_mm /= touched;
    mean.at.y_mm /= touched;
    return mean;
}

} // namespace tactor::engine
