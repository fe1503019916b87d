// SPDX-License-Identifier: MIT
#include "synth/score/score.hpp"

#include <algorithm>
#include <deque>
#include <functional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "core/start_times.hpp"
#include "core/words.hpp"
#include "plan/job.hpp"
#include "synth/limits/guard.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/levels.hpp"
#include "synth/tone/make_timbre.hpp"
#include "synth/wave/event.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using synth::item;
using synth::item_kind;

constexpr double latest_start_s = 1e6;

unsigned count_channels(const array& a, const render_options& o)
{
    const unsigned needed = a.channels();
    const unsigned channels = o.channels == 0 ? needed : o.channels;
    if (channels < needed) {
        throw detail::bad_field(
            "channels",
            fmt::format("{} are too few: the array has a tactor on channel {}", channels, needed - 1),
            fmt::format("use {} or more", needed));
    }
    if (channels > detail::max_channels) {
        throw detail::bad_field("channels", fmt::format("{} are too many", channels),
                                fmt::format("use at most {}", detail::max_channels));
    }
    return channels;
}

void check_options(const render_options& o)
{
    if (o.rate < 8000 || o.rate > 768000) {
        throw detail::bad_field("rate", fmt::format("{} Hz cannot be rendered", o.rate),
                                "use 8000 to 768000, such as 48000");
    }
    if (o.ramp_s && !(*o.ramp_s >= 0.0 && *o.ramp_s <= latest_start_s)) {
        throw detail::bad_field("ramp_s", fmt::format("{} s is not a ramp", *o.ramp_s),
                                "use 0 or more, such as 0.002");
    }
    synth::check_envelope(o.envelope);
}

void check_marker(const array& a, const render_options& o, unsigned channels)
{
    if (!o.marker_channel)
        return;
    const std::string what = fmt::format("marker channel {}", *o.marker_channel);
    if (*o.marker_channel >= channels) {
        throw error(error_kind::bad_input, what,
                    fmt::format("there {} {}", channels == 1 ? "is" : "are", counted(channels, "channel")),
                    fmt::format("use {} or more", counted(*o.marker_channel + 1, "channel")))
            .with_field("marker_channel");
    }
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        if (a.tactors[i].channel == *o.marker_channel) {
            throw error(error_kind::bad_input, what, fmt::format("it drives tactor {}", i),
                        "choose a spare channel")
                .with_field("marker_channel");
        }
    }
    if (!(o.marker_s > 0.0 && o.marker_s <= 10.0)) {
        throw detail::bad_field("marker_s", fmt::format("{} s is out of range", o.marker_s),
                                "use more than 0, at most 10 s, such as 0.005");
    }
}

/// Places a marker at the start of each plan. Markers do not make the score longer.
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
            s.marker = channel;
        }
    }
}

void check_carrier(const plan& p, unsigned rate)
{
    if (!(p.carrier_hz > 0.0 && p.carrier_hz < 0.5 * rate)) {
        throw detail::bad_field(
            synth::carrier_field(p),
            fmt::format("{} Hz cannot be rendered at a rate of {} Hz", p.carrier_hz, rate),
            fmt::format("use a carrier above 0 and below {} Hz, half the rate", 0.5 * rate));
    }
}

void check_start(double start_s)
{
    if (!(start_s >= 0.0 && start_s <= latest_start_s)) {
        throw error(error_kind::bad_input, "start of the stroke",
                    fmt::format("{} s cannot be rendered", start_s),
                    fmt::format("use 0 to {} s", latest_start_s))
            .with_field("start_s");
    }
}

/// Returns the greatest sum of `weight` over the items that are open at once. Items must be in order of
/// start.
template <class End, class Weight>
std::size_t max_open_weight(const std::deque<item>& items, End end, Weight weight)
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

/// Sorts items by start, unless they are in order already, as they usually are: a sort needs half as much
/// memory again.
void sort_by_start(std::deque<item>& items)
{
    const auto earlier = [](const item& x, const item& y) { return x.start < y.start; };
    if (!std::is_sorted(items.begin(), items.end(), earlier))
        std::stable_sort(items.begin(), items.end(), earlier);
}

void measure(score::impl& s)
{
    const auto& items = s.list.items;
    const auto events = [](std::size_t drives) {
        return (drives + synth::drives_per_event - 1) / synth::drives_per_event;
    };
    const auto end = [](const item& it) { return it.end(); };
    // A burst that fits into one event needs its expander only at its start.
    const auto walked = [](const item& it) {
        return it.kind == item_kind::burst && it.length <= synth::longest_event ? it.start : it.end();
    };
    const auto is_continuous = [](const item& it) { return it.kind == item_kind::continuous; };
    s.open_items = max_open_weight(items, walked, [](const item&) { return std::size_t{1}; });
    s.open_continuous =
        max_open_weight(items, end, [&](const item& it) { return std::size_t{is_continuous(it) ? 1U : 0U}; });
    s.open_events = max_open_weight(items, end, [&](const item& it) {
        return is_continuous(it)             ? s.tactors.size() // a line for each tactor
               : it.kind == item_kind::burst ? events(it.count)
                                             : std::size_t{1};
    });
}

/// Returns the carrier of a plan at a time.
double hz_at(const plan& p, double t_s)
{
    // For a recording along the path the carrier profile holds its repetition rate.
    if (p.course.empty() || p.wave.kind == waveform_kind::recording)
        return p.carrier_hz;
    const auto after = std::upper_bound(p.course.begin(), p.course.end(), t_s,
                                        [](double t, const carrier_point& c) { return t < c.t_s; });
    if (after == p.course.begin())
        return after->hz;
    const carrier_point& before = *(after - 1);
    if (after == p.course.end())
        return before.hz;
    return detail::hz_between(before, *after, (t_s - before.t_s) / (after->t_s - before.t_s));
}

} // namespace

/// A score that is being made.
struct score_builder::impl {
    impl(const array& tactors, const render_options& options)
        : a(tactors), o(options), s(synth::begin_score(a, o))
    {
    }

    std::uint32_t number() const noexcept { return static_cast<std::uint32_t>(s->plans.size()); }

    /// Returns the frame at which the next plan starts. Computes it from the time, because adding up the
    /// frames of earlier plans would accumulate rounding errors.
    std::uint64_t start(std::optional<double> start_s, const start_anchor& anchor)
    {
        const double at_s = times.start(start_s, anchor);
        if (start_s)
            check_start(at_s);
        return synth::frame_at(at_s, o.rate);
    }

    std::uint64_t place(std::span<const burst> bursts, std::size_t first, const plan& p, std::uint64_t start)
    {
        return synth::place_bursts(bursts, first, p, number(), start, a.tactors.size(), o, s->list);
    }

    /// Completes a plan whose bursts are placed.
    void close(plan p, std::optional<double> start_s, const start_anchor& anchor, std::uint64_t start,
               std::uint64_t bursts_end)
    {
        times.set_duration(p.total_s);
        s->sounds.push_back(shelf.get(p, o.rate));
        const std::uint64_t end = synth::append_continuous_item(p, number(), start, bursts_end, o, s->list);
        p.bursts = {};
        s->plans.push_back({std::move(p), start_s, anchor});
        s->starts.push_back(start);
        s->ends.push_back(end);
        s->frames = std::max(s->frames, end);
    }

    array a;
    render_options o;
    std::shared_ptr<score::impl> s;
    detail::start_times times;
    synth::timbre_shelf shelf;
};

score_builder::score_builder(const array& a, const render_options& o) : impl_(std::make_unique<impl>(a, o))
{
}

score_builder::~score_builder() = default;

void score_builder::add(plan p, std::optional<double> start_s, const start_anchor& anchor)
{
    check_carrier(p, impl_->o.rate);
    const std::uint64_t start = impl_->start(start_s, anchor);
    const std::uint64_t end = impl_->place(p.bursts, 0, p, start);
    impl_->close(std::move(p), start_s, anchor, start, end);
}

void score_builder::add(const layout& l, const stroke& s, const plan_options& o)
{
    const std::uint64_t start = impl_->start(s.start_s, s.anchor);
    std::uint64_t end = start;
    std::size_t placed = 0;
    plan p = detail::plan_in_pieces(impl_->a, l, s, o, [&](const plan& so_far, std::span<const burst> next) {
        check_carrier(so_far, impl_->o.rate);
        end = std::max(end, impl_->place(next, placed, so_far, start));
        placed += next.size();
    });
    impl_->close(std::move(p), s.start_s, s.anchor, start, end);
}

score score_builder::take()
{
    // Takes the contents first, so that no partial score remains if memory runs out or levels are refused.
    const auto done = std::exchange(impl_, std::make_unique<impl>(impl_->a, impl_->o));
    score::impl& s = *done->s;
    const render_options& o = done->o;
    synth::end_items(s, o);
    std::vector<double> peaks = synth::check_peaks(done->s, done->a, o);
    s.boosted = synth::boost_rises(s, done->a, peaks);
    if (s.boosted) {
        sort_by_start(s.list.items);
        measure(s);
    }
    s.peaks = std::move(peaks);
    return detail::access::make<score>(std::shared_ptr<const score::impl>(std::move(done->s)));
}

score::score(const array& a, std::vector<placed_plan> plans, const render_options& o)
{
    score_builder b(a, o);
    for (placed_plan& p : plans)
        b.add(std::move(p.plan), p.start_s, p.anchor);
    *this = b.take();
}

std::vector<double> start_times_s(std::span<const placed_plan> plans)
{
    detail::start_times times;
    for (const placed_plan& p : plans) {
        times.start(p.start_s, p.anchor);
        times.set_duration(p.plan.total_s);
    }
    return std::move(times).all();
}

std::vector<placed_plan> score::alone(plan p)
{
    std::vector<placed_plan> one;
    one.push_back({std::move(p), {}});
    return one;
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

const weakening& score::weakened() const noexcept
{
    return impl_->weakened;
}

const std::vector<placed_plan>& score::plans() const noexcept
{
    return impl_->plans;
}

double score::impl::equalising_factor(std::size_t tactor, std::uint32_t plan, std::uint64_t frame) const
{
    if (measured.empty())
        return 1.0;
    const double t_s = (static_cast<double>(frame) - static_cast<double>(starts[plan])) / rate;
    return synth::threshold_factor(measured[tactor], hz_at(plans[plan].plan, t_s));
}

double score::impl::max_equalising_factor(std::size_t tactor, std::uint32_t plan) const
{
    if (measured.empty())
        return 1.0;
    const tactor_spec& t = measured[tactor];
    const tactor::plan& p = plans[plan].plan;
    double most = synth::threshold_factor(t, hz_at(p, 0.0));
    double low = p.carrier_hz;
    double high = p.carrier_hz;
    for (const carrier_point& c : p.course) {
        most = std::max(most, synth::threshold_factor(t, hz_at(p, c.t_s)));
        low = std::min(low, c.hz);
        high = std::max(high, c.hz);
    }
    // Between two points of the course the carrier may pass one of the thresholds.
    for (const threshold_point& q : t.thresholds)
        if (q.hz > low && q.hz < high)
            most = std::max(most, synth::threshold_factor(t, q.hz));
    return most;
}

} // namespace v0
} // namespace tactor

namespace tactor::synth {

void check_envelope(const burst_envelope& e)
{
    const auto check_ramp = [](const char* what, std::optional<double> s) {
        if (s && !(*s >= 0.0 && *s <= 10.0))
            throw detail::bad_field(what, fmt::format("{} s is not a ramp", *s), "use 0 to 10, such as 0.01");
    };
    check_ramp("attack_s", e.attack_s);
    check_ramp("release_s", e.release_s);
    if (!(e.tukey_part >= 0.0 && e.tukey_part <= 1.0))
        throw detail::bad_field("tukey_part", fmt::format("{} is out of range", e.tukey_part), "use 0 to 1");
}

std::shared_ptr<score::impl> begin_score(const array& a, const render_options& o)
{
    validate(a);
    check_options(o);
    auto s = std::make_shared<score::impl>();
    s->rate = o.rate;
    s->phase = o.phase;
    s->envelope = o.envelope;
    s->channels = count_channels(a, o);
    check_marker(a, o, s->channels);
    if (o.limits)
        s->guards = make_guards(*o.limits, o.rate);
    s->tactors = tactor_levels(a, o);
    s->unmeasured = unmeasured_tactors(a, o);
    const auto curved = [](const tactor_spec& t) { return !t.thresholds.empty(); };
    if (o.sl_db && std::any_of(a.tactors.begin(), a.tactors.end(), curved))
        s->measured = a.tactors;
    s->limits = channel_limits(a, s->channels);
    return s;
}

void end_items(score::impl& s, const render_options& o)
{
    if (o.marker_channel)
        place_markers(s, frame_at(o.marker_s, o.rate), *o.marker_channel);
    sort_by_start(s.list.items);
    measure(s);
}

} // namespace tactor::synth
