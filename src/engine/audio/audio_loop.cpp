// SPDX-License-Identifier: MIT
#include "engine/audio/audio_loop.hpp"

#include <algorithm>
#include <cerrno>
#include <latch>
#include <span>
#include <utility>

#include <sys/resource.h>

#include "rt/clock.hpp"

namespace tactor::engine {
namespace {

// Number of idle wake-ups after which the loop sleeps instead of trusting the descriptors, so that it cannot
// spin.
constexpr unsigned many_idle_steps = 16;

// While something sounds, the control side wakes at least this often, and reads the drive time of other
// programs.
constexpr unsigned least_wakes_per_s = 10;

// Number of gain ramps that fit in a second: a gain change takes 20 ms.
constexpr unsigned ramps_per_s = 50;

// Maximum time to resume: snd_pcm_resume() may return "not yet" for ever; a device needs a few seconds at
// most.
constexpr std::int64_t longest_resume = 10 * rt::ns_per_s;

reason_kind to_reason(io_kind s) noexcept
{
    return s == io_kind::lost ? reason_kind::lost : reason_kind::failed;
}

} // namespace

audio_loop::audio_loop(sink& s, link& l, std::span<const double> limits, const loop_options& o)
    : sink_(s),
      link_(l),
      options_(o),
      setup_(s.setup()),
      mixer_(limits, setup_.format, o.drives + live_reserve(setup_), o.guards),
      scores_(mixer_, l, o.fade_frames, live_reserve(setup_), setup_.rate / ramps_per_s),
      clock_(setup_.rate, setup_.batch ? setup_.period_frames : 0),
      frame_bytes_(setup_.frame_bytes()),
      block_(setup_.period_frames * frame_bytes_)
{
    for (std::size_t i = 0; i < o.driven_s.size(); ++i)
        mixer_.raise(i, o.driven_s[i]);
    if (o.guards.drive_frames > 0.0) {
        l.driven = std::vector<std::atomic<std::uint64_t>>(limits.size());
        l.raised.resize(limits.size());
    }
    l.amplifier.ready.store(!o.amplifier, std::memory_order_relaxed);
}

void audio_loop::step(io_kind ready, std::int64_t now) noexcept TACTOR_NONBLOCKING
{
    ++idle_steps_;
    ++still_steps_;
    now_ns_ = now;
    if (std::exchange(fresh_, false))
        record_progress(now);
    take_requests();
    handle_amplifier_state();
    switch (phase_) {
    case phase::idle:
    case phase::over:
        return;
    case phase::closing:
        advance_closing(ready, now);
        break;
    case phase::suspended:
        try_resume(now);
        break;
    case phase::running:
        take_commands();
        write_if_ready(ready, now);
        break;
    }
    if (phase_ == phase::running) {
        update_position(now);
        scores_.update(played_);
        if (stop_requested_)
            finish_if_silent();
    }
    // In a long buffer the fade comes too late, after everything that was written before it.
    if (phase_ == phase::running && stop_requested_ && now - stop_requested_ns_ >= longest_stop_ns)
        finish(stop_why_, 0, true);
    // Checks wake-ups and time, so that a process that was stopped and continues does not treat its device as
    // dead. Frames that the sink accepts do not count: a stroke whose end never reaches the DAC would wait
    // for ever.
    if (phase_ == phase::running && still_steps_ >= 4 && now - moved_ns_ > options_.stall_ns)
        finish(reason_kind::lost, -ETIMEDOUT);
    publish();
}

bool audio_loop::polls_sink() const noexcept
{
    return (phase_ == phase::running || (phase_ == phase::closing && end_runs_)) &&
           idle_steps_ < many_idle_steps;
}

std::int64_t audio_loop::timeout_ns() const noexcept
{
    const std::int64_t period = std::int64_t{setup_.period_frames} * rt::ns_per_s / setup_.rate;
    const std::int64_t normal = polls_sink() ? 4 * period : period;
    if (phase_ == phase::running && stop_requested_)
        return std::min(normal, std::max<std::int64_t>(stop_requested_ns_ + longest_stop_ns - now_ns_, 0));
    return phase_ == phase::closing ? std::min(normal, longest_stop_ns) : normal;
}

void audio_loop::take_requests() noexcept
{
    request r;
    while (link_.requests.pop(r)) {
        switch (r.what) {
        case request::kind::cancel:
            scores_.cancel(r.score);
            break;
        case request::kind::live:
            scores_.begin_live(r);
            break;
        case request::kind::stop:
            if (!stop_requested_ && r.closing)
                scores_.stop(state_kind::interrupted, reason_kind::closed);
            else if (!stop_requested_)
                scores_.stop(state_kind::cancelled, reason_kind::none);
            request_stop();
            break;
        }
    }
}

void audio_loop::take_commands() noexcept
{
    const std::size_t waiting = link_.commands.size();
    // The feeder was in time, but has more drives than the ring holds.
    if (link_.feeder_waits.load(std::memory_order_relaxed))
        scores_.record_crowding();
    std::size_t n = 0;
    for (; n < waiting && process_command(*link_.commands.front()); ++n)
        link_.commands.drop_front();
    // Does not wake the feeder for every free place, but once a quarter of the ring is free.
    if (n == 0 || waiting - n > link_.commands.capacity() - link_.commands.capacity() / 4)
        return;
    // Either the feeder sees the space when it looks again, or this thread sees that the feeder waits.
    std::atomic_thread_fence(std::memory_order_seq_cst);
    if (link_.feeder_waits.exchange(false, std::memory_order_seq_cst))
        link_.to_control.signal();
}

bool audio_loop::process_command(const command& c) noexcept
{
    // The amplifier must be on and settled before a score begins; until then commands stay in the ring.
    const bool held = !stop_requested_ && !link_.amplifier.ready.load(std::memory_order_acquire);
    switch (c.what) {
    case command::kind::begin:
        if (scores_.take_cancellation(c.score))
            return true;
        if (held)
            return false;
        scores_.begin(c, offset_);
        break;
    case command::kind::drive:
        return scores_.add(c);
    case command::kind::end:
        scores_.end(c.score);
        break;
    }
    return true;
}

void audio_loop::mix_period() noexcept
{
    link_.raised.take([this](std::size_t channel, double level_s) { mixer_.raise(channel, level_s); });
    scores_.update_gains();
    scores_.render_live(setup_.period_frames, offset_, clock_.line());
    // Drives that wait in the ring for space in the mixer have come in time.
    if (link_.commands.size() == 0)
        scores_.fade_late_scores(setup_.period_frames);
    const bool sounds = mixer_.size() != 0;
    if (link_.sounds.exchange(sounds, std::memory_order_relaxed) != sounds && sounds)
        link_.to_control.signal(); // the control side enters this drive in the book before it is played
    mixer_.process(setup_.period_frames, block_.data());
    pending_ = setup_.period_frames;
    pending_from_ = 0;
    link_.count.periods.fetch_add(1, std::memory_order_relaxed);
    const synth::mixer_counts counts = mixer_.counts();
    link_.count.limited.store(counts.limited, std::memory_order_relaxed);
    link_.count.power_limited.store(counts.power_limited, std::memory_order_relaxed);
    link_.count.drives_cut.store(counts.drives_cut, std::memory_order_relaxed);
    for (std::size_t i = 0; i < link_.driven.size(); ++i)
        link_.driven[i].store(mixer_.driven(i), std::memory_order_relaxed);
}

io_result audio_loop::write_pending() noexcept
{
    const io_result r =
        sink_.write(std::span(block_).subspan(pending_from_ * frame_bytes_, pending_ * frame_bytes_));
    const std::size_t taken = std::min(r.frames, pending_);
    pending_ -= taken;
    pending_from_ += taken;
    link_.count.frames.fetch_add(taken, std::memory_order_relaxed);
    return {r.status, taken, r.code};
}

void audio_loop::write_if_ready(io_kind ready, std::int64_t now) noexcept
{
    // After two idle wake-ups, writes anyway: a wake-up may have been lost, or the state may have changed
    // without a wake-up.
    if (ready == io_kind::ok || (ready == io_kind::again && idle_steps_ > 2))
        write_periods(now);
    else if (ready != io_kind::again)
        handle_break(ready, 0, now);
}

void audio_loop::write_periods(std::int64_t now) noexcept
{
    const io_result available = sink_.available();
    if (available.status != io_kind::ok)
        return handle_break(available.status, available.code, now);
    std::size_t room = available.frames;
    if (room > setup_.period_frames)
        link_.count.late_frames.store(
            std::max<std::uint64_t>(link_.count.late_frames.load(std::memory_order_relaxed),
                                    room - setup_.period_frames),
            std::memory_order_relaxed);

    // Limits the loop even if a device claims more space than its buffer has.
    room = std::min<std::size_t>(room, setup_.buffer_frames);
    while (room > 0) {
        if (pending_ == 0) {
            if (room < setup_.period_frames)
                break;
            take_commands();
            if (scores_.needs_drives())
                link_.count.low_water.store(
                    std::min<std::uint64_t>(link_.count.low_water.load(std::memory_order_relaxed),
                                            mixer_.size()),
                    std::memory_order_relaxed);
            mix_period();
        }
        const io_result r = write_pending();
        if (r.frames > 0)
            idle_steps_ = 0;
        if (r.status == io_kind::again || (r.status == io_kind::ok && r.frames == 0))
            break;
        if (r.status != io_kind::ok)
            return handle_break(r.status, r.code, now);
        room -= std::min(r.frames, room);
    }
}

void audio_loop::update_position(std::int64_t now) noexcept
{
    const stream_position p = sink_.position();
    if (!p.valid || p.played <= played_)
        return;
    played_ = p.played;
    clock_.add(p.time_ns, offset_ + p.played);
    publish_clock(clock_.line());
    record_start_times(played_);
    record_progress(now);
}

void audio_loop::record_start_times(std::uint64_t played) noexcept
{
    clock_line line = clock_.line();
    if (!line.valid()) {
        // An xrun came before the first reading: only the start time of the DAC is known.
        line.frame = offset_;
        line.time_ns = epoch_ns_;
        line.ns_per_frame = 1e9 / setup_.rate;
    }
    scores_.record_start_times(played, offset_, line);
}

void audio_loop::record_progress(std::int64_t now) noexcept
{
    moved_ns_ = now;
    still_steps_ = 0;
    idle_steps_ = 0;
}

// Stores sync_clock first, so that it has the epoch of any pulse that is planned with link::clock.
void audio_loop::publish_clock(const clock_line& line) noexcept
{
    link_.sync_clock.store(line);
    link_.clock.store(line);
}

void audio_loop::publish() noexcept
{
    stream_status s{.written = offset_ + mixer_.position(),
                    .played = offset_ + played_,
                    .running = phase_ == phase::running,
                    .stage = phase_,
                    .epoch = clock_.line().epoch,
                    .epoch_played = played_,
                    .mutes = mutes_};
    scores_.describe(played_, s);
    link_.status.store(s);
    link_.amplifier.status.store(s);

    // Strokes that begin at a given time wait for the clock of each epoch.
    const bool clocked = clock_.line().valid();
    const bool news =
        s.stage != reported_stage_ || s.epoch != reported_epoch_ || clocked != reported_clocked_;
    reported_stage_ = s.stage;
    reported_epoch_ = s.epoch;
    reported_clocked_ = clocked;
    // Until strokes may begin, wakes the amplifier's thread in each step.
    if (options_.amplifier && (news || !link_.amplifier.ready.load(std::memory_order_relaxed)))
        link_.amplifier.wake.signal();

    const bool hungry = link_.feeding.load(std::memory_order_relaxed) &&
                        s.written - woken_frame_ >= std::min<std::uint64_t>(options_.horizon_frames / 8,
                                                                            setup_.rate / least_wakes_per_s);
    if (hungry)
        woken_frame_ = s.written;
    if (hungry || news || link_.reports.available() != link_.reports.capacity())
        link_.to_control.signal();
}

io_result audio_loop::start(std::int64_t now) noexcept
{
    now_ns_ = now;
    const io_result r = begin_epoch();
    if (r.status == io_kind::ok) {
        begin_running(now);
        publish();
    }
    return r;
}

void audio_loop::begin_running(std::int64_t now) noexcept
{
    phase_ = phase::running;
    record_progress(now);
    fresh_ = true;
}

io_result audio_loop::begin_epoch() noexcept
{
    mixer_.reset();
    pending_ = 0;
    played_ = 0;
    // A device that is still suspended fails here in each period. Such a failure must not begin an epoch.
    if (const io_kind s = sink_.prepare(); s != io_kind::ok)
        return {s, 0, 0};
    clock_.begin_epoch(offset_);
    publish_clock(clock_.line());
    std::size_t filled = 0;
    while (filled < setup_.buffer_frames && pending_ == 0) {
        mix_period();
        const io_result r = write_pending();
        if (r.status != io_kind::ok && r.status != io_kind::again)
            return r;
        filled += r.frames;
    }
    if (filled == 0)
        return {io_kind::failed, 0, -EIO};
    epoch_ns_ = now_ns_;
    return {sink_.start(), filled, 0};
}

void audio_loop::handle_break(io_kind s, int code, std::int64_t now) noexcept
{
    if (phase_ == phase::closing) {
        end_runs_ = end_runs_ && (s == io_kind::ok || s == io_kind::again);
        return; // nothing sounds any more; the loop only waits for the amplifier
    }
    switch (s) {
    case io_kind::ok:
    case io_kind::again:
        return;
    case io_kind::xrun:
        link_.count.count_xrun(sink_.xrun_ns());
        // The DAC stopped because it had played everything.
        silence_all(reason_kind::xrun, code, mixer_.position() - pending_);
        return exceeds_recovery_limit(now) ? finish(reason_kind::lost, -EPIPE) : restart(now);
    case io_kind::suspended:
        return handle_suspend(code, now);
    case io_kind::lost:
    case io_kind::failed:
        return finish(to_reason(s), code);
    }
}

// Ends the strokes that had begun, because no burst resumes in the middle. Returns the others to the control
// side, which hands them over again.
void audio_loop::silence_all(reason_kind why, int code, std::uint64_t played) noexcept
{
    record_start_times(played);
    scores_.interrupt(why, code, played, !stop_requested_);
    offset_ += mixer_.position();
    publish_clock({});
    mixer_.reset();
    pending_ = 0;
    played_ = 0;
}

void audio_loop::handle_suspend(int code, std::int64_t now) noexcept
{
    link_.count.suspends.fetch_add(1, std::memory_order_release);
    silence_all(reason_kind::suspended, code, played_);
    phase_ = phase::suspended;
    suspended_ns_ = now;
}

void audio_loop::try_resume(std::int64_t now) noexcept
{
    if (stop_requested_)
        return finish(stop_why_, 0);
    scores_.handle_live_requests(); // usually a part of the mix, but there is no mix now
    if (sink_.resume() == io_kind::again && now - suspended_ns_ < longest_resume)
        return;
    // Begins a new epoch even if the device resumed, because the buffer holds frames of interrupted strokes.
    restart(now);
}

void audio_loop::restart(std::int64_t now) noexcept
{
    if (stop_requested_)
        return finish(stop_why_, 0);
    io_result r = begin_epoch();
    while (r.status == io_kind::xrun) {
        silence_all(reason_kind::xrun, r.code, 0);
        if (exceeds_recovery_limit(now))
            return finish(reason_kind::lost, -EPIPE);
        r = begin_epoch();
    }
    if (r.status == io_kind::ok)
        begin_running(now);
    else if (r.status == io_kind::suspended)
        handle_suspend(r.code, now); // not awake yet: try again in the next period
    else
        finish(to_reason(r.status), r.code);
}

bool audio_loop::exceeds_recovery_limit(std::int64_t now) noexcept
{
    std::int64_t& oldest = recoveries_[recovered_ % recoveries_.size()];
    if (recovered_ >= recoveries_.size() && now - oldest < rt::ns_per_s)
        return true;
    oldest = now;
    ++recovered_;
    return false;
}

void audio_loop::request_stop() noexcept
{
    if (!stop_requested_)
        stop_requested_ns_ = now_ns_;
    stop_requested_ = true;
}

void audio_loop::finish_if_silent() noexcept
{
    if (!scores_.empty())
        return;
    if (stop_frame_ == 0)
        stop_frame_ = played_ + setup_.period_frames; // also waits for the delay of the DAC itself
    if (played_ >= stop_frame_)
        finish(stop_why_, 0, true);
}

// Ends the stream. The line goes off first, if possible, because a DAC that stops while the amplifier is on
// makes a pop. `runs`: the stream still works, so zeros are written until the line is off.
void audio_loop::finish(reason_kind why, int code, bool runs) noexcept
{
    if (phase_ == phase::over)
        return;
    if (phase_ == phase::closing) {
        end_runs_ = false;
        return;
    }
    scores_.interrupt(why, code, played_, false);
    mixer_.cut(); // silences strokes that could not fade yet; their ends have been reported
    end_why_ = why;
    end_code_ = code;
    end_runs_ = runs;
    closing_ns_ = now_ns_;
    phase_ = phase::closing;
    // Pairs with amplifier_driver::switch_on().
    link_.amplifier.ending.store(true, std::memory_order_seq_cst);
    if (link_.amplifier.off.load(std::memory_order_seq_cst))
        end();
}

void audio_loop::advance_closing(io_kind ready, std::int64_t now) noexcept
{
    if (link_.amplifier.off.load(std::memory_order_seq_cst) ||
        link_.amplifier.stuck.load(std::memory_order_seq_cst) || now - closing_ns_ >= options_.off_ns)
        return end();
    if (end_runs_)
        write_if_ready(ready, now);
}

void audio_loop::end() noexcept
{
    sink_.drop();
    publish_clock({});
    phase_ = phase::over;
    // This reason replaces any other, because a person must act on it.
    if (!link_.amplifier.off.load(std::memory_order_seq_cst)) {
        link_.amplifier.stuck.store(true, std::memory_order_seq_cst);
        end_why_ = reason_kind::left_on;
    }
    link_.reports.push({.what = report::kind::stream_over, .why = end_why_, .code = end_code_});
}

void audio_loop::handle_amplifier_state() noexcept
{
    if (phase_ != phase::running && phase_ != phase::suspended)
        return;
    const std::uint32_t mutes = link_.amplifier.mutes.load(std::memory_order_acquire);
    if (mutes != mutes_)
        scores_.mute();
    mutes_ = mutes;
    if (link_.amplifier.failed.load(std::memory_order_acquire) && stop_why_ == reason_kind::none) {
        request_stop();
        stop_why_ = reason_kind::amplifier;
        scores_.stop(state_kind::interrupted, reason_kind::amplifier);
    }
}

namespace {

// Counter of this thread's page faults, read once a second. Skips the first wake-ups, which touch new memory.
class fault_watch {
public:
    explicit fault_watch(counters& c) noexcept : count_(c) {}

    void step(std::int64_t now) noexcept
    {
        constexpr unsigned warm_up = 16;
        if (steps_ < warm_up) {
            if (++steps_ == warm_up && getrusage(RUSAGE_THREAD, &before_) == 0)
                looked_ns_ = now;
        } else if (now - looked_ns_ >= rt::ns_per_s) {
            look();
            looked_ns_ = now;
        }
    }

    void look() noexcept
    {
        rusage u{};
        if (looked_ns_ == 0 || getrusage(RUSAGE_THREAD, &u) != 0)
            return;
        count_.minor_faults = static_cast<std::uint64_t>(u.ru_minflt - before_.ru_minflt);
        count_.major_faults = static_cast<std::uint64_t>(u.ru_majflt - before_.ru_majflt);
    }

private:
    counters& count_;
    rusage before_{};
    std::int64_t looked_ns_ = 0;
    unsigned steps_ = 0;
};

} // namespace

audio_thread::audio_thread(audio_loop& loop, sink& s, link& l, const rt::thread_options& o)
    : loop_(loop), sink_(s), link_(l), fds_(s.max_descriptors() + 1)
{
    std::latch begun(1);
    // The audio thread itself starts the stream: ALSA's handle belongs to one thread, and nothing may delay
    // the first period after the start.
    thread_ = std::make_unique<rt::thread>(o, [this, &begun] {
        started_ = loop_.start(rt::monotonic_ns());
        begun.count_down();
        if (started_.status == io_kind::ok)
            run();
    });
    begun.wait();
}

void audio_thread::run() noexcept TACTOR_NONBLOCKING
{
    fault_watch faults(link_.count);
    rt::busy_watch busy;
    while (!loop_.over()) {
        const io_kind ready = wait();
        const std::int64_t now = rt::monotonic_ns();
        loop_.step(ready, now);
        faults.step(now);
        if (busy.look(now)) {
            link_.count.realtime_given_up.store(true, std::memory_order_relaxed);
            link_.to_control.signal();
        }
    }
    faults.look();
    link_.to_control.signal();
}

io_kind audio_thread::wait() noexcept
{
    const rt::permitted_call here{};
    const bool asks_sink = loop_.polls_sink();
    const std::size_t n =
        asks_sink ? sink_.descriptors(std::span(fds_).first(fds_.size() - 1)) : std::size_t{0};
    fds_[n] = {.fd = link_.to_audio.fd(), .events = POLLIN, .revents = 0};

    const timespec timeout = rt::to_timespec(loop_.timeout_ns());
    if (::ppoll(fds_.data(), n + 1, &timeout, nullptr) < 0)
        return io_kind::again;
    if (fds_[n].revents != 0)
        link_.to_audio.consume();
    return asks_sink ? sink_.ready(std::span(fds_).first(n)) : io_kind::again;
}

} // namespace tactor::engine
