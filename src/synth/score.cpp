// SPDX-License-Identifier: MIT
#include "synth/score.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include <tactor/words.hpp>

#include <tactor/error.hpp>

#include "synth/frames.hpp"
#include "synth/guard.hpp"
#include "synth/levels.hpp"
#include "synth/mixer.hpp"
#include "synth/place.hpp"

namespace tactor {

namespace {

using synth::item;
using synth::item_kind;

constexpr unsigned most_channels = 16384; // of an array; no PCM has so many
constexpr double latest_start_s = 1e6;

unsigned channels_of(const array& a, const render_options& o)
{
    const unsigned needed = a.channels();
    const unsigned channels = o.channels == 0 ? needed : o.channels;
    if (channels < needed) {
        throw error(errc::bad_input, "channels",
                    fmt::format("{} are too few: the array has a tactor on channel {}", channels, needed - 1),
                    fmt::format("ask for {} or more", needed));
    }
    if (channels > most_channels) {
        throw error(errc::bad_input, "channels", fmt::format("{} are too many", channels),
                    fmt::format("at most {} can be rendered", most_channels));
    }
    return channels;
}

void check_options(const render_options& o)
{
    if (o.rate < 8000 || o.rate > 768000) {
        throw error(errc::bad_input, "rate", fmt::format("{} Hz cannot be rendered", o.rate),
                    "use 8000 to 768000, e.g. 48000");
    }
    if (o.ramp_s && !(*o.ramp_s >= 0.0 && *o.ramp_s <= latest_start_s)) {
        throw error(errc::bad_input, "ramp_s", fmt::format("{} s is not a ramp", *o.ramp_s),
                    "use 0 or more, e.g. 0.002");
    }
}

void check_marker(const array& a, const render_options& o, unsigned channels)
{
    if (!o.marker_channel) {
        return;
    }
    const std::string what = fmt::format("marker channel {}", *o.marker_channel);
    if (*o.marker_channel >= channels) {
        throw error(errc::bad_input, what,
                    fmt::format("there {} {}", channels == 1 ? "is" : "are", counted(channels, "channel")),
                    fmt::format("ask for {} or more", counted(*o.marker_channel + 1, "channel")));
    }
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        if (a.tactors[i].channel == *o.marker_channel) {
            throw error(errc::bad_input, what, fmt::format("it drives tactor {}", i),
                        "choose a spare channel");
        }
    }
    if (!(o.marker_s > 0.0 && o.marker_s <= 10.0)) {
        throw error(errc::bad_input, "marker", fmt::format("{} s is not its length", o.marker_s),
                    "use above 0 to 10 s, e.g. 0.005");
    }
}

/// One at the start of each plan; none makes the piece longer.
void place_markers(score::impl& s, std::uint64_t length, unsigned channel)
{
    for (std::size_t i = 0; i < s.starts.size(); ++i) {
        item it;
        it.kind = item_kind::marker;
        it.start = s.starts[i];
        it.length = std::min(std::max<std::uint64_t>(length, 1), s.frames - std::min(it.start, s.frames));
        it.plan = static_cast<std::uint32_t>(i);
        it.tactor = static_cast<std::uint16_t>(channel);
        if (it.length > 0) {
            s.list.items.push_back(it);
        }
    }
}

void check_carrier(double carrier_hz, unsigned rate)
{
    if (!(carrier_hz > 0.0 && carrier_hz < 0.5 * rate)) {
        throw error(errc::bad_input, "carrier_hz",
                    fmt::format("{} Hz cannot be rendered at a rate of {} Hz", carrier_hz, rate),
                    fmt::format("use a carrier above 0 and below {} Hz, half the rate", 0.5 * rate));
    }
}

std::uint64_t start_frame(const placed_plan& p, unsigned rate, std::uint64_t end_before)
{
    if (!p.start_s) {
        return end_before;
    }
    if (!(*p.start_s >= 0.0 && *p.start_s <= latest_start_s)) {
        throw error(errc::bad_input, "start of the stroke",
                    fmt::format("{} s cannot be rendered", *p.start_s),
                    fmt::format("use 0 to {} s", latest_start_s));
    }
    return synth::frame_at(*p.start_s, rate);
}

/// Greatest sum of `weight` over the items that are open at once; they arrive by start.
template <class End, class Weight>
std::size_t most_open(const std::vector<item>& items, End end, Weight weight)
{
    using open = std::pair<std::uint64_t, std::size_t>;
    std::vector<open> heap;
    std::size_t sum = 0;
    std::size_t most = 0;
    for (const item& it : items) {
        while (!heap.empty() && heap.front().first < it.start) {
            std::pop_heap(heap.begin(), heap.end(), std::greater<>{});
            sum -= heap.back().second;
            heap.pop_back();
        }
        const std::size_t w = weight(it);
        if (w > 0) {
            heap.emplace_back(end(it), w);
            std::push_heap(heap.begin(), heap.end(), std::greater<>{});
            most = std::max(most, sum += w);
        }
    }
    return most;
}

void measure(score::impl& s)
{
    const auto& items = s.list.items;
    const auto events = [](std::size_t drives) {
        return (drives + synth::drives_per_event - 1) / synth::drives_per_event;
    };
    const auto end = [](const item& it) { return it.end(); };
    // A burst shorter than the longest event is through as soon as it has begun.
    const auto walked = [](const item& it) {
        return it.kind == item_kind::burst && it.length <= synth::longest_event ? it.start : it.end();
    };
    s.open_items = most_open(items, walked, [](const item&) -> std::size_t { return 1; });
    s.open_continuous = most_open(
        items, end, [](const item& it) -> std::size_t { return it.kind == item_kind::continuous ? 1 : 0; });
    s.open_events = most_open(items, end, [&](const item& it) -> std::size_t {
        switch (it.kind) {
        case item_kind::burst:
            return events(it.count);
        case item_kind::continuous:
            return events(s.tactors.size());
        case item_kind::joined:
        case item_kind::marker:
            break;
        }
        return 1;
    });
}

/// Exact where no bursts overlap, so that vectors need not grow by doubling.
void reserve(score::impl& s)
{
    std::size_t bursts = 0;
    std::size_t drives = 0;
    for (const placed_plan& p : s.plans) {
        bursts += p.schedule.bursts.size() + (p.schedule.at ? 1 : 0);
        for (const burst& b : p.schedule.bursts) {
            drives += b.drives.size();
        }
    }
    s.list.items.reserve(bursts);
    s.list.drive_tactors.reserve(drives);
    s.list.drive_amplitudes.reserve(drives);
}

std::shared_ptr<const score::impl> make_score(const array& a, std::vector<placed_plan> plans,
                                              const render_options& o)
{
    validate(a);
    check_options(o);
    auto s = std::make_shared<score::impl>();
    s->rate = o.rate;
    s->phase = o.phase;
    s->channels = channels_of(a, o);
    check_marker(a, o, s->channels);
    if (o.limits) {
        synth::check_limits(*o.limits);
    }
    s->tactors = synth::tactor_levels(a, o);
    s->limits = synth::channel_limits(a, s->channels);
    s->plans = std::move(plans);
    reserve(*s);
    std::uint64_t end = 0;
    for (const placed_plan& p : s->plans) {
        check_carrier(p.schedule.carrier_hz, o.rate);
        const std::uint64_t start = start_frame(p, o.rate, end);
        end = synth::place_plan(p.schedule, static_cast<std::uint32_t>(s->starts.size()), start,
                                a.tactors.size(), o, s->list);
        s->starts.push_back(start);
        s->ends.push_back(end);
        s->frames = std::max(s->frames, end);
    }
    if (o.marker_channel) {
        place_markers(*s, synth::frame_at(o.marker_s, o.rate), *o.marker_channel);
    }
    s->guards = o.limits;
    const auto earlier = [](const item& x, const item& y) { return x.start < y.start; };
    // Mostly they are in order; sorting needs room for half of them again.
    if (!std::is_sorted(s->list.items.begin(), s->list.items.end(), earlier)) {
        std::stable_sort(s->list.items.begin(), s->list.items.end(), earlier);
    }
    synth::check_peaks(*s, a, o);
    measure(*s);
    return s;
}

} // namespace

std::string_view to_string(phase_mode p) noexcept
{
    return p == phase_mode::stroke ? "stroke" : "burst";
}

score::score(const array& a, std::vector<placed_plan> plans, const render_options& o)
    : impl_(make_score(a, std::move(plans), o))
{
}

std::uint64_t score::frames() const noexcept
{
    return impl_->frames;
}

unsigned score::channels() const noexcept
{
    return impl_->channels;
}

unsigned score::rate() const noexcept
{
    return impl_->rate;
}

const std::vector<std::uint64_t>& score::starts() const noexcept
{
    return impl_->starts;
}

const std::vector<placed_plan>& score::plans() const noexcept
{
    return impl_->plans;
}

const std::shared_ptr<const score::impl>& score::data() const noexcept
{
    return impl_;
}

} // namespace tactor
