// SPDX-License-Identifier: MIT
#include "engine/control/line_threads.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <optional>
#include <utility>

#include <poll.h>

#include "rt/clock.hpp"

namespace tactor::engine {
namespace {

// Sleeps until a signal comes, for `ns` at most, and consumes the signal.
void await_signal(rt::event_fd& e, std::int64_t ns) noexcept
{
    const timespec timeout = rt::to_timespec(ns);
    pollfd fd{.fd = e.fd(), .events = POLLIN, .revents = 0};
    if (::ppoll(&fd, 1, &timeout, nullptr) > 0)
        e.consume();
}

} // namespace

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
    check_audio_thread(s, now);
    send_heartbeat(now);
    const bool withheld = line_.must_be_off();
    if (std::exchange(withheld_, withheld) != withheld)
        amplifier_.handle(withheld ? amplifier::event::withheld : amplifier::event::granted, now);
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
    // Reports a suspend while the stream is suspended, and also if the system slept and woke between two
    // calls.
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
void amplifier_driver::check_audio_thread(const stream_status& s, std::int64_t now) noexcept
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

void amplifier_driver::send_heartbeat(std::int64_t now) noexcept
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
    const std::int64_t now = clock_(); // send_heartbeat() may have blocked
    if (is_retrying()) {
        if (now - tried_ns_ >= options_.retry_ns)
            try_switch_off();
    } else if (amplifier_.line() && line_state_ == line_state::off)
        switch_on();
    else if (!amplifier_.line() && line_state_ == line_state::on)
        switch_off();
    link_.amplifier.ready.store(amplifier_.ready(), std::memory_order_release);
    if (amplifier_.ready() != ready_before)
        link_.to_audio.signal();
}

// Switches on, unless the stream is ending. The audio thread may decide to stop the DAC at this moment:
// either the audio thread sees that the line is (about to be) on and waits, or this thread sees that the
// stream is ending.
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
        return try_switch_off(); // a line that reports a failure may have switched all the same
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
    try_switch_off();
}

// Switches off. A line behind a bus (an I2C expander) may refuse once and obey the next time.
void amplifier_driver::try_switch_off() noexcept
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
        try_switch_off(); // for the last time
}

std::int64_t amplifier_driver::next_ns() const noexcept
{
    const auto due = amplifier_.deadline();
    const std::int64_t now = clock_();
    if (is_retrying())
        return std::clamp<std::int64_t>(tried_ns_ + options_.retry_ns - now, 0, options_.retry_ns);
    // If the deadline had passed at the last update, the amplifier waits for an event, not for time.
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
    while (driver_.is_retrying()) {
        sleep();
        driver_.update();
    }
}

void amplifier_thread::sleep() noexcept
{
    await_signal(link_.amplifier.wake, driver_.next_ns());
}

namespace {

constexpr bool is_taken(std::uint32_t turn) noexcept
{
    return turn % 2 == 1;
}

constexpr std::int64_t idle_ns = 60 * rt::ns_per_s;
// Longest sleep before the clock is read again: the clock improves with time, and an xrun ends its line.
constexpr std::int64_t longest_wait_ns = 100'000'000;
constexpr std::int64_t no_clock_ns = 2'000'000;
// Delay after which a pulse is dropped: a pulse at a wrong time is worse than none.
constexpr std::int64_t latest_pulse_ns = 20'000'000;
// Time before a pulse is due at which the emitter starts to sleep for this pulse alone.
constexpr std::int64_t pulse_lead_ns = 2'000'000;

class system_time final : public pulse_time {
public:
    std::int64_t now() noexcept override { return rt::monotonic_ns(); }
    void sleep_until(std::int64_t time_ns) noexcept override
    {
        const timespec t = rt::to_timespec(time_ns);
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
        }
    }
};

system_time& real_time() noexcept
{
    static system_time t;
    return t;
}

} // namespace

// Acquire and release: a reader that sees one word of a newer pulse also sees the newer turn.
pulse pulse_board::read(const place& p) noexcept
{
    return {.epoch = p.epoch.load(std::memory_order_acquire),
            .frame = p.frame.load(std::memory_order_acquire),
            .id = p.id.load(std::memory_order_acquire)};
}

void pulse_board::fill(place& p, const pulse& what, std::uint32_t turn) noexcept
{
    p.epoch.store(what.epoch, std::memory_order_release);
    p.frame.store(what.frame, std::memory_order_release);
    p.id.store(what.id, std::memory_order_release);
    p.turn.store(turn + 1, std::memory_order_release);
}

bool pulse_board::end_turn(std::size_t n, std::uint32_t turn) noexcept
{
    return places_[n].turn.compare_exchange_strong(turn, turn + 1, std::memory_order_acq_rel);
}

std::optional<pulse> pulse_board::offer(const pulse& p) noexcept
{
    std::size_t last = places;
    pulse latest = p;
    std::uint32_t latest_turn = 0;
    for (std::size_t n = 0; n < places; ++n) {
        const std::uint32_t turn = places_[n].turn.load(std::memory_order_acquire);
        if (!is_taken(turn)) {
            fill(places_[n], p, turn);
            return std::nullopt;
        }
        if (const pulse here = read(places_[n]); here > latest) {
            last = n;
            latest = here;
            latest_turn = turn;
        }
    }
    if (last == places)
        return p;
    const bool made_way = end_turn(last, latest_turn);
    // The place is free in either case: if its pulse was not removed here, the sender has just taken it.
    fill(places_[last], p, latest_turn + 1);
    return made_way ? std::optional(latest) : std::nullopt;
}

template <typename Unwanted>
std::size_t pulse_board::remove(Unwanted unwanted) noexcept
{
    std::size_t removed = 0;
    for (std::size_t n = 0; n < places; ++n) {
        const std::uint32_t turn = places_[n].turn.load(std::memory_order_acquire);
        if (is_taken(turn) && unwanted(read(places_[n])) && end_turn(n, turn))
            ++removed;
    }
    return removed;
}

std::size_t pulse_board::forget(stroke_id id) noexcept
{
    return remove([id](const pulse& p) { return p.id == id; });
}

void pulse_board::forget_other_epochs(std::uint64_t epoch) noexcept
{
    remove([epoch](const pulse& p) { return p.epoch != epoch; });
}

std::optional<pulse_board::seen> pulse_board::next(const clock_line& line) const noexcept
{
    std::optional<seen> first;
    for (std::size_t n = 0; n < places; ++n) {
        const std::uint32_t turn = places_[n].turn.load(std::memory_order_acquire);
        if (!is_taken(turn))
            continue;
        const seen here{.what = read(places_[n]), .place = n, .turn = turn};
        if (here.what.epoch == line.epoch && (!first || here.what < first->what) &&
            places_[n].turn.load(std::memory_order_acquire) == turn)
            first = here;
    }
    return first;
}

trigger_thread::trigger_thread(link& l, enable_line& line, std::int64_t pulse_ns, const rt::thread_options& t,
                               pulse_time* time)
    : link_(l),
      line_(line),
      time_(time != nullptr ? *time : real_time()),
      emitter_(line, pulse_ns, time_),
      thread_(t, [this] { run(); })
{
}

trigger_thread::~trigger_thread()
{
    over_.store(true, std::memory_order_release);
    wake_.signal();
    thread_.join();
}

void trigger_thread::add(stroke_id id, std::uint64_t frame, const clock_line& clock)
{
    if (plan_.add(id, frame, clock))
        wake_.signal();
}

void trigger_thread::hand_over()
{
    if (plan_.hand_over())
        wake_.signal();
}

pulse_stats trigger_thread::stats() noexcept
{
    pulse_stats s = stats_.load();
    s.missed += plan_.missed();
    return s;
}

void trigger_thread::run() noexcept
{
    while (!over_.load(std::memory_order_acquire))
        await_signal(wake_, step());
    line_.set(false);
}

// Handles the next pulse. Returns the time until the next call is needed, ns.
std::int64_t trigger_thread::step() noexcept
{
    const clock_line line = link_.sync_clock.load();
    const std::optional<pulse_board::seen> p = line.epoch != 0 ? board_.next(line) : std::nullopt;
    if (!p)
        return line.epoch != 0 ? idle_ns : longest_wait_ns;
    if (!line.valid())
        return no_clock_ns;
    const std::int64_t due = line.time_at(p->what.frame);
    const std::int64_t wait_ns = due - time_.now() - pulse_lead_ns;
    if (wait_ns > 0)
        return std::min(wait_ns, longest_wait_ns);
    const bool in_time = emitter_.await(due);
    // The pulse may have been withdrawn meanwhile, and an xrun may have ended its epoch.
    if (board_.take(*p)) {
        if (!in_time)
            emitter_.count_miss();
        else if (link_.sync_clock.load().epoch == p->what.epoch)
            emitter_.send(due);
    }
    stats_.store(emitter_.stats());
    link_.to_control.signal();
    return 0;
}

void pulse_plan::forget(stroke_id id, bool was_played)
{
    const std::size_t unsent =
        std::erase_if(waiting_, [id](const pulse& p) { return p.id == id; }) + board_.forget(id);
    missed_ += was_played ? unsent : 0;
    hand_over();
}

bool pulse_plan::add(stroke_id id, std::uint64_t frame, const clock_line& line)
{
    board_.forget_other_epochs(line.epoch);
    std::erase_if(waiting_, [&line](const pulse& p) { return p.epoch != line.epoch; });
    if (line.epoch == 0 || frame < line.first)
        return false;
    waiting_.insert({.epoch = line.epoch, .frame = frame, .id = id});
    hand_over();
    return true;
}

bool pulse_plan::hand_over()
{
    bool any = false;
    while (!waiting_.empty()) {
        const pulse first = *waiting_.begin();
        const std::optional<pulse> displaced = board_.offer(first);
        if (displaced == first)
            break;
        any = true;
        waiting_.erase(waiting_.begin());
        if (displaced)
            waiting_.insert(*displaced);
    }
    return any;
}

bool pulse_emitter::await(std::int64_t due_ns) noexcept
{
    if (time_.now() - due_ns > latest_pulse_ns)
        return false;
    time_.sleep_until(due_ns - cost_ns_);
    return true;
}

void pulse_emitter::send(std::int64_t due_ns) noexcept
{
    const std::int64_t before = time_.now();
    if (!line_.set(true)) {
        ++stats_.missed;
        line_.set(false);
        return;
    }
    const std::int64_t on = time_.now();
    // The first call may include page faults.
    cost_ns_ = stats_.sent < 2 ? on - before : cost_ns_ + (on - before - cost_ns_) / 8;
    const double late = static_cast<double>(on - due_ns) * 1e-9;
    ++stats_.sent;
    stats_.mean_late_s += (late - stats_.mean_late_s) / static_cast<double>(stats_.sent);
    stats_.worst_late_s = std::max(stats_.worst_late_s, late);
    time_.sleep_until(on + pulse_ns_);
    line_.set(false);
}

} // namespace tactor::engine
