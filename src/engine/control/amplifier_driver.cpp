// SPDX-License-Identifier: MIT
#include "engine/control/amplifier_driver.hpp"

#include <algorithm>
#include <utility>

#include <poll.h>

#include "rt/clock.hpp"

namespace tactor::engine {

amplifier_driver::amplifier_driver(link& l, enable_line& line, const driver_options& o,
                                   std::function<std::int64_t()> clock)
    : link_(l),
      line_(line),
      options_(o),
      clock_(std::move(clock)),
      amplifier_(o.amplifier),
      updated_ns_(clock_())
{
}

void amplifier_driver::update() noexcept
{
    const std::int64_t now = clock_();
    const stream_status s = link_.amplifier.status.load();
    read_status(s, now);
    watch(s, now);
    beat(now);
    amplifier_.handle(amplifier::event::tick, now);
    apply();
    report_changes();
    updated_ns_ = now;
}

// Wakes the control side, which writes the log, after a change.
void amplifier_driver::report_changes() noexcept
{
    const bool ready = link_.amplifier.ready.load(std::memory_order_relaxed);
    const std::uint64_t events = link_.amplifier.mutes.load(std::memory_order_relaxed) +
                                 link_.count.stalls.load(std::memory_order_relaxed) +
                                 link_.count.off_failures.load(std::memory_order_relaxed);
    if (std::exchange(reported_ready_, ready) != ready || std::exchange(reported_events_, events) != events)
        link_.to_control.signal();
}

void amplifier_driver::read_status(const stream_status& s, std::int64_t now) noexcept
{
    const std::uint64_t xruns = link_.count.xruns.load(std::memory_order_acquire);
    for (; xruns_ < xruns; ++xruns_)
        amplifier_.handle(amplifier::event::xrun, now);
    // Reports a suspend also if the system slept and woke between two looks, and while it sleeps, whatever
    // came before.
    const std::uint64_t suspends = link_.count.suspends.load(std::memory_order_acquire);
    if (std::exchange(suspends_, suspends) != suspends || s.stage == stream_stage::suspended)
        amplifier_.handle(amplifier::event::suspended, now);
    if (s.epoch != epoch_) {
        epoch_ = s.epoch;
        amplifier_.handle(amplifier::event::started, now);
    }
    if (s.stage == stream_stage::running) {
        // Until the audio thread has seen the mute, frames that it wrote earlier still sound.
        const bool heard = s.mutes == link_.amplifier.mutes.load(std::memory_order_relaxed);
        amplifier_.handle(amplifier::event::moved, now,
                          {.played = s.epoch_played, .sounds_until = heard ? s.sounds_until : UINT64_MAX});
    }
    if (link_.amplifier.ending.load(std::memory_order_seq_cst))
        amplifier_.handle(amplifier::event::silent, now);
}

// Measures how long the audio thread stood still. Time in which this thread did not run either (SIGSTOP, a
// debugger) does not count.
void amplifier_driver::watch(const stream_status& s, std::int64_t now) noexcept
{
    const std::uint64_t periods = link_.count.periods.load(std::memory_order_relaxed);
    if (periods != periods_ || s.stage != stream_stage::running) {
        periods_ = periods;
        idle_ns_ = 0;
        if (std::exchange(stalled_, false))
            amplifier_.handle(amplifier::event::recovered, now);
        return;
    }
    idle_ns_ += std::min(now - updated_ns_, 2 * options_.beat_ns);
    if (stalled_ || idle_ns_ < options_.watchdog_ns)
        return;
    stalled_ = true;
    link_.count.stalls.fetch_add(1, std::memory_order_relaxed);
    amplifier_.handle(amplifier::event::stalled, now);
}

void amplifier_driver::beat(std::int64_t now) noexcept
{
    if (line_state_ != line_state::on || now - beaten_ns_ < options_.beat_ns)
        return;
    beaten_ns_ = now;
    if (line_.beat())
        return;
    // The line went off by itself or was lost. apply() switches it off in either case.
    link_.count.stalls.fetch_add(1, std::memory_order_relaxed);
    amplifier_.handle(amplifier::event::lapsed, now);
}

void amplifier_driver::apply() noexcept
{
    const bool ready_before = link_.amplifier.ready.load(std::memory_order_relaxed);
    if (!amplifier_.ready())
        link_.amplifier.ready.store(false, std::memory_order_release);
    if (trying()) {
        if (clock_() - tried_ns_ >= options_.retry_ns)
            try_off();
    } else if (amplifier_.line() && line_state_ == line_state::off)
        switch_on();
    else if (!amplifier_.line() && line_state_ == line_state::on)
        switch_off();
    link_.amplifier.ready.store(amplifier_.ready(), std::memory_order_release);
    if (amplifier_.ready() != ready_before)
        link_.to_audio.signal();
}

// Switches on, unless the stream ends. The audio thread may decide to stop the DAC at this moment: either it
// sees that the line is (about to be) on and waits, or this thread sees that it is ending.
void amplifier_driver::switch_on() noexcept
{
    link_.amplifier.off.store(false, std::memory_order_seq_cst);
    if (link_.amplifier.ending.load(std::memory_order_seq_cst)) {
        link_.amplifier.off.store(true, std::memory_order_seq_cst);
        amplifier_.handle(amplifier::event::silent, clock_());
        return;
    }
    line_state_ = line_state::on;
    if (!line_.set(true)) {
        fail();
        return try_off(); // a line that reports a failure may have switched all the same
    }
    const std::int64_t now = clock_();
    beaten_ns_ = now;
    amplifier_.handle(amplifier::event::switched, now);
}

void amplifier_driver::switch_off() noexcept
{
    if (!link_.amplifier.ending.load(std::memory_order_relaxed))
        // The strokes that sound now are not felt any more.
        link_.amplifier.mutes.fetch_add(1, std::memory_order_release);
    try_off();
}

// Switches off. A line behind a bus (an I2C expander) may refuse once and obey the next time.
void amplifier_driver::try_off() noexcept
{
    const bool off = line_.set(false);
    tried_ns_ = clock_();
    if (off) {
        line_state_ = line_state::off;
        link_.amplifier.off.store(true, std::memory_order_seq_cst);
        link_.to_audio.signal();
        return;
    }
    link_.count.off_failures.fetch_add(1, std::memory_order_relaxed);
    if (line_state_ != line_state::refused)
        refused_ns_ = tried_ns_;
    line_state_ = line_state::refused;
    if (!stuck_ && tried_ns_ - refused_ns_ >= options_.persist_ns) {
        stuck_ = true;
        link_.amplifier.stuck.store(true, std::memory_order_seq_cst);
        fail();
    }
}

void amplifier_driver::fail() noexcept
{
    link_.amplifier.failed.store(true, std::memory_order_release);
    link_.to_audio.signal();
    amplifier_.handle(amplifier::event::failed, clock_());
}

void amplifier_driver::close() noexcept
{
    amplifier_.handle(amplifier::event::silent, clock_());
    apply();
    if (stuck_)
        try_off(); // for the last time
}

std::int64_t amplifier_driver::next_ns() const noexcept
{
    const auto due = amplifier_.deadline();
    const std::int64_t now = clock_();
    if (trying())
        return std::clamp<std::int64_t>(tried_ns_ + options_.retry_ns - now, 0, options_.retry_ns);
    // A deadline that had passed at the last update waits for an event, not for time.
    return due && *due > updated_ns_ ? std::clamp<std::int64_t>(*due - now, 0, options_.beat_ns)
                                     : options_.beat_ns;
}

amplifier_thread::amplifier_thread(link& l, enable_line& line, const driver_options& o,
                                   const rt::thread_options& t)
    : link_(l), driver_(l, line, o, rt::monotonic_ns), thread_(t, [this] { run(); })
{
}

amplifier_thread::~amplifier_thread()
{
    over_.store(true, std::memory_order_release);
    link_.amplifier.wake.signal();
    thread_.join();
}

void amplifier_thread::run() noexcept
{
    while (!over_.load(std::memory_order_acquire)) {
        driver_.update();
        sleep();
    }
    driver_.close();
    while (driver_.trying()) {
        sleep();
        driver_.update();
    }
}

void amplifier_thread::sleep() noexcept
{
    const timespec timeout = rt::to_timespec(driver_.next_ns());
    pollfd fd{.fd = link_.amplifier.wake.fd(), .events = POLLIN, .revents = 0};
    if (::ppoll(&fd, 1, &timeout, nullptr) > 0)
        link_.amplifier.wake.consume();
}

} // namespace tactor::engine
