// SPDX-License-Identifier: MIT
#include "synth/score/joined.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/access.hpp"
#include "synth/score/score.hpp"

namespace tactor::synth {

namespace {

// Returns an empty score for the same array, rate and channels.
std::shared_ptr<score::impl> begin_matching_score(const score::impl& model)
{
    auto s = std::make_shared<score::impl>();
    s->tactors = model.tactors;
    s->limits = model.limits;
    s->guards = model.guards;
    s->channels = model.channels;
    s->rate = model.rate;
    s->peaks.resize(model.peaks.size());
    return s;
}

} // namespace

score join_scores(const std::vector<placed_score>& parts)
{
    const score::impl& first = detail::access::of(parts.front().score);
    auto all = begin_matching_score(first);
    all->marker = first.marker;
    for (const placed_score& p : parts) {
        const score::impl& one = detail::access::of(p.score);
        for (std::size_t i = 0; i < one.plans.size(); ++i) {
            all->starts.push_back(p.start + one.starts[i]);
            all->ends.push_back(p.start + one.ends[i]);
            all->plans.push_back({one.plans[i].plan, static_cast<double>(all->starts.back()) / one.rate});
        }
        for (std::size_t i = 0; i < one.peaks.size(); ++i)
            all->peaks[i] = std::max(all->peaks[i], one.peaks[i]);
        all->boosted = all->boosted || one.boosted;
        all->frames = std::max(all->frames, p.start + one.frames);
        all->open_items = std::max(all->open_items, one.open_items);
        all->open_continuous = std::max(all->open_continuous, one.open_continuous);
        all->open_events += one.open_events; // the last events of a part may meet the first of the next part
        if (one.parts.empty())
            all->parts.push_back({detail::access::shared(p.score), p.start});
        for (const score_part& inner : one.parts)
            all->parts.push_back({inner.made, p.start + inner.start});
    }
    std::ranges::stable_sort(all->parts, {}, &score_part::start);
    return detail::access::make<score>(std::shared_ptr<const score::impl>(std::move(all)));
}

score make_code(const score& like, unsigned channel, std::uint64_t bit_frames, unsigned number)
{
    auto s = begin_matching_score(detail::access::of(like));
    s->marker_level = 0.5;
    s->plans.emplace_back();
    s->sounds.emplace_back();
    s->starts.push_back(0);
    s->frames = code_bits * bit_frames;
    const unsigned bits = number << 1 | 1;
    for (unsigned i = 0; i < code_bits; ++i)
        if ((bits >> i & 1) != 0)
            s->list.items.push_back({.start = i * bit_frames,
                                     .length = bit_frames,
                                     .tactor = static_cast<std::uint16_t>(channel),
                                     .kind = item_kind::marker});
    auto code = begin_matching_score(*s);
    code->marker = channel;
    code->frames = s->frames;
    code->open_items = code->open_events = 2; // a bit may begin where another ends
    code->parts.push_back(
        {std::move(s), 0}); // added as a part, because its plan is not one of the score's plans
    return detail::access::make<score>(std::shared_ptr<const score::impl>(std::move(code)));
}

} // namespace tactor::synth
