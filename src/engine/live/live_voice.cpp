// SPDX-License-Identifier: MIT
#include "engine/live/live_voice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "synth/score/frames.hpp"

namespace tactor::engine {
namespace {

// Adds one more point with its delay.
void count(live_delay& d, std::int64_t ns) noexcept
{
    const double s = 1e-9 * static_cast<double>(ns);
    d.least_s = d.points == 0 ? s : std::min(d.least_s, s);
    d.most_s = d.points == 0 ? s : std::max(d.most_s, s);
    ++d.points;
    d.mean_s += (s - d.mean_s) / static_cast<double>(d.points);
}

} // namespace

std::size_t live_drives(std::size_t channels, unsigned period_frames, unsigned rate) noexcept
{
    // In one period: two lines and a fade, or the bursts that may begin in it and those that still sound.
    const double bursts = 2.0 + period_frames / (least_live_soa_s * rate);
    return static_cast<std::size_t>(std::ceil(std::max(3.0, bursts))) *
           ((channels + synth::drives_per_event - 1) / synth::drives_per_event);
}

live_voice::live_voice(const live_setup& s)
    : setup_(s),
      points_(
          live_course{.amplitudes = std::vector<double>(s.channels * (s.window == 0 ? 1 : live_knots), 0.0)}),
      from_(s.channels, 0.0),
      to_(s.channels, 0.0)
{
}

void live_voice::request(action w) noexcept
{
    // The first request counts, with two exceptions: a cancel may still shorten an end, and a failure must be
    // reported.
    action now = requested_.load(std::memory_order_relaxed);
    while (now < w && !requested_.compare_exchange_weak(now, w, std::memory_order_release)) {
    }
}

void live_voice::fail(std::string why) noexcept
{
    failure_ = std::move(why);
    request(action::fail);
}

void live_voice::wait(std::uint64_t frames) noexcept
{
    if (points_.fetch()) {
        has_point_ = true;
        idle_ = 0;
    } else if (requested() == action::go_on) {
        idle_ += frames; // after its end the producer owes no more points
    }
}

bool live_voice::try_begin(ticket t, std::uint64_t next) noexcept
{
    has_point_ = points_.fetch() || has_point_;
    if (!has_point_)
        return false;
    ticket_ = t;
    first_ns_ = points_.value().at_ns;
    has_begun_ = true;
    base_ = next;
    end_ = next;
    next_burst_ = next;
    aim(0);
    length_ = setup_.step;
    place_ = 0;
    idle_ = 0;
    return true;
}

bool live_voice::render(synth::mixer& m, std::uint64_t frames, std::uint64_t offset,
                        const clock_line& clock) noexcept
{
    const dac_times t{offset, clock};
    bool fits = true;
    if (setup_.bursts) {
        const std::uint64_t end = m.position() + frames;
        for (; fits && next_burst_ < end; next_burst_ += setup_.soa)
            fits = burst(m, next_burst_, t);
    } else {
        fits = follow(m, frames, t);
    }
    // A burst takes the newest point; until then the point waits.
    idle_ = setup_.bursts && points_.has_news() ? 0 : idle_ + frames;
    rendered_.store(m.position() + frames - base_, std::memory_order_relaxed);
    return fits;
}

// Renders continuous strokes: linear from the amplitudes of one point to those of the next, while the carrier
// runs on.
bool live_voice::follow(synth::mixer& m, std::uint64_t frames, const dac_times& t) noexcept
{
    const std::uint64_t end = m.position() + frames;
    bool fits = true;
    for (std::uint64_t at = m.position(); fits && at < end;) {
        if (place_ >= length_) {
            std::swap(from_, to_);
            take(at, t);
            length_ = std::max(setup_.step, end - at);
            aim(at + length_ - base_);
            place_ = 0;
        }
        const std::uint64_t n = std::min(end - at, length_ - place_);
        const double start = static_cast<double>(place_) / static_cast<double>(length_);
        const double stop = static_cast<double>(place_ + n) / static_cast<double>(length_);
        synth::drive_event e;
        e.start = at;
        e.phase_frame = at - base_;
        e.length = static_cast<std::uint32_t>(n);
        fits = add(m, e, [&](std::size_t c) {
            const double d = to_[c] - from_[c];
            return std::pair(from_[c] + d * start, from_[c] + d * stop);
        });
        at += n;
        place_ += n;
        end_ = at;
    }
    return fits;
}

// Takes the newest point, if one has come. Frames from `at` on have it.
void live_voice::take(std::uint64_t at, const dac_times& t) noexcept
{
    if (!points_.fetch())
        return;
    idle_ = 0;
    if (!t.clock.valid())
        return;
    count(later_, t.clock.time_at(t.offset + at) - points_.value().at_ns);
}

live_delay live_voice::delay(std::int64_t started_ns) const noexcept
{
    live_delay all = later_;
    count(all, started_ns - first_ns_);
    return all;
}

// Sets the amplitudes that the newest course has at a frame of the stroke.
void live_voice::aim(std::uint64_t frame) noexcept
{
    const live_course& c = points_.value();
    const std::size_t last = c.knots - 1;
    const std::uint64_t elapsed = std::min(frame - std::min(frame, c.start), c.length);
    const std::uint64_t scaled = elapsed * last;
    const std::uint64_t knot = c.length == 0 ? last : scaled / c.length;
    const double* a = &c.amplitudes[knot * setup_.channels];
    std::copy(a, a + setup_.channels, to_.begin());
    if (knot == last)
        return;
    const double part = static_cast<double>(scaled % c.length) / static_cast<double>(c.length);
    for (std::size_t n = 0; n < setup_.channels; ++n)
        to_[n] += (a[setup_.channels + n] - a[n]) * part;
}

bool live_voice::burst(synth::mixer& m, std::uint64_t at, const dac_times& t) noexcept
{
    take(at, t);
    synth::drive_event e;
    e.start = at;
    e.phase_frame = setup_.restart ? 0 : at - base_;
    e.phase_origin = at - base_ - e.phase_frame;
    e.window = setup_.duration;
    const double half_cycles = 2.0 * setup_.cycles_per_frame;
    e.ramp = synth::between_zeros(half_cycles * static_cast<double>(e.phase_frame),
                                  half_cycles * static_cast<double>(e.phase_frame + setup_.duration))
                 ? setup_.ramp
                 : setup_.cut_ramp;
    e.release = synth::release_frames(setup_.envelope, setup_.rate, setup_.duration, e.ramp);
    e.shape = setup_.envelope.kind;
    e.length = static_cast<std::uint32_t>(setup_.duration);
    end_ = at + setup_.duration;
    aim(at - base_);
    return add(m, e, [this](std::size_t c) { return std::pair(to_[c], to_[c]); });
}

bool live_voice::fade(synth::mixer& m, std::uint32_t frames) noexcept
{
    synth::drive_event e;
    e.start = m.position();
    e.phase_frame = e.start - base_;
    e.ramp_position = frames; // the falling half of the window
    e.window = 2 * std::uint64_t{frames};
    e.ramp = frames;
    e.length = frames;
    end_ = e.start + frames;
    return frames == 0 || add(m, e, [this](std::size_t c) {
               const double a = amplitude(c);
               return std::pair(a, a);
           });
}

double live_voice::amplitude(std::size_t channel) const noexcept
{
    const double part = static_cast<double>(place_) / static_cast<double>(length_);
    return from_[channel] + (to_[channel] - from_[channel]) * part;
}

// Adds an event by channels. `part` returns the amplitudes of a channel at both ends of the event.
template <typename Part>
bool live_voice::add(synth::mixer& m, synth::drive_event e, Part part) noexcept
{
    e.cycles_per_frame = setup_.cycles_per_frame;
    e.sound = setup_.sound.get();
    e.score = ticket_;
    e.drives = 0;
    for (std::size_t c = 0; c < setup_.channels; ++c) {
        const auto [from, to] = part(c);
        if (from == 0.0 && to == 0.0)
            continue;
        e.drive[e.drives++] = {.from = from, .to = to, .channel = static_cast<std::uint32_t>(c)};
        if (e.drives == synth::drives_per_event) {
            if (!m.add(e))
                return false;
            e.drives = 0;
        }
    }
    return e.drives == 0 || m.add(e);
}

} // namespace tactor::engine
