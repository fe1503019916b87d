// SPDX-License-Identifier: MIT
#include "synth/score/joined.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/access.hpp"
#include "synth/score/score.hpp"

namespace tactor::synth {

score join_scores(const std::vector<placed_score>& parts)
{
    const score::impl& first = detail::access::of(parts.front().score);
    auto all = std::make_shared<score::impl>();
    all->tactors = first.tactors;
    all->limits = first.limits;
    all->guards = first.guards;
    all->channels = first.channels;
    all->rate = first.rate;
    all->marker = first.marker;
    all->asked.resize(first.asked.size());
    for (const placed_score& p : parts) {
        const score::impl& one = detail::access::of(p.score);
        for (std::size_t i = 0; i < one.plans.size(); ++i) {
            all->starts.push_back(p.start + one.starts[i]);
            all->ends.push_back(p.start + one.ends[i]);
            all->plans.push_back({one.plans[i].plan, static_cast<double>(all->starts.back()) / one.rate});
        }
        for (std::size_t i = 0; i < one.asked.size(); ++i)
            all->asked[i] = std::max(all->asked[i], one.asked[i]);
        all->boosted = all->boosted || one.boosted;
        all->frames = std::max(all->frames, p.start + one.frames);
        all->open_items = std::max(all->open_items, one.open_items);
        all->open_continuous = std::max(all->open_continuous, one.open_continuous);
        all->open_events += one.open_events; // those of two parts meet where one follows at once
        all->parts.push_back({detail::access::shared(p.score), p.start});
    }
    return detail::access::make<score>(std::shared_ptr<const score::impl>(std::move(all)));
}

} // namespace tactor::synth
