// SPDX-License-Identifier: MIT
#include "session/play_session.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include <poll.h>
#include <unistd.h>

#include "core/words.hpp"
#include "rt/advice.hpp"
#include "session/own_memory.hpp"
#include "session/say.hpp"
#include "session/sound_server.hpp"

namespace tactor::session {
namespace {

constexpr int frame_ms = 40;   // of the picture: 25 a second
constexpr int settled_ms = 10; // more than one turn of the audio thread takes
constexpr int kept_ms = 1000;  // how often it is kept that the array is driven
constexpr int proof_ms = 1000; // a device that was lost is back when it has held for so long
constexpr double longest_pause_s = 5.0;

constexpr std::ptrdiff_t most_xrun_lengths = 64; // as player_stats::xrun_s has of one stream

} // namespace

void add_stats(player_stats& sum, const player_stats& more)
{
    const bool first = sum.periods == 0;
    sum.ring_low_water = first ? more.ring_low_water : std::min(sum.ring_low_water, more.ring_low_water);
    sum.realtime = more.realtime && (first || sum.realtime);
    sum.periods += more.periods;
    sum.frames += more.frames;
    sum.xruns += more.xruns;
    sum.limited_frames += more.limited_frames;
    sum.power_limited_frames += more.power_limited_frames;
    sum.drives_cut += more.drives_cut;
    sum.stalls += more.stalls;
    sum.off_failures += more.off_failures;
    sum.left_on = more.left_on; // a later player may have switched it off
    const auto pulses = static_cast<double>(sum.sync_pulses + more.sync_pulses);
    if (pulses > 0.0)
        sum.sync_mean_late_s = (sum.sync_mean_late_s * static_cast<double>(sum.sync_pulses) +
                                more.sync_mean_late_s * static_cast<double>(more.sync_pulses)) /
                               pulses;
    sum.sync_pulses += more.sync_pulses;
    sum.sync_missed += more.sync_missed;
    sum.sync_worst_late_s = std::max(sum.sync_worst_late_s, more.sync_worst_late_s);
    sum.minor_faults += more.minor_faults;
    sum.major_faults += more.major_faults;
    sum.latest_wakeup_s = std::max(sum.latest_wakeup_s, more.latest_wakeup_s);
    sum.xrun_s.insert(sum.xrun_s.end(), more.xrun_s.begin(), more.xrun_s.end());
    if (std::ssize(sum.xrun_s) > most_xrun_lengths) // the newest are kept
        sum.xrun_s.erase(sum.xrun_s.begin(), sum.xrun_s.end() - most_xrun_lengths);
}

void warn_of_cuts(const drive_limits& l, const player_stats& s)
{
    if (s.drives_cut != 0)
        fmt::print(
            stderr,
            "tactor: warning: tactors were driven for longer than {} s in {} s: {} cut short or silent "
            "([limits] max_drive_s in the array file or configuration)\n",
            l.max_drive_s, l.window_s, counted(s.drives_cut, "drive"));
}

std::optional<error> left_on(const player_stats& s)
{
    if (!s.left_on)
        return std::nullopt;
    return error(error_kind::not_available, "amplifier",
                 fmt::format("its line cannot be switched off, {} failed: it may be on",
                             counted(s.off_failures, "try", "tries")),
                 "cut the amplifier's supply; then see whether \"{command:off}\" works, and what dmesg says");
}

play_session::play_session(const alsa_options& device, const stream_options& o, const environment& e,
                           stream_source source)
    : options_(o),
      environment_(e),
      source_(std::move(source)),
      lines_(o.no_gpio ? tactor::setup{} : e.config, o.arm, o.sync_delay_ms * 1e-3),
      log_(o.verbose, o.log),
      device_(device),
      kept_(device.pcm, settle_limits(o, e))
{
    device_.log = log_.function();
    std::unique_ptr<sink> s = source_.open(device_);
    limit_runaway_threads();
    const std::string refused = lock_own_memory();
    locked_ = refused.empty();
    if (!locked_ && o.require_realtime)
        throw error(error_kind::not_available, "locked memory", refused,
                    rt::realtime_advice(probe_realtime_rights(), player_options{}.priority));
    start(std::move(s));
    for (const device_note& n : wiring_notes(environment_.tactors, setup_))
        say(stderr, "tactor: warning: {} ({})\n", n.text, n.cure);
    warn_of_rights(player_->stats().realtime, locked_);
}

play_session::~play_session()
{
    try {
        end_stream();
    } catch (const std::exception&) { // NOLINT(bugprone-empty-catch): what is kept counts too much then
    }
}

void play_session::end_stream()
{
    if (!std::exchange(streams_, false))
        return;
    player_->stop();
    kept_.settled(player_->history());
}

void play_session::start(std::unique_ptr<sink> s, double proof_s)
{
    player_options o = source_.player;
    o.limits = settle_limits(options_, environment_);
    o.require_realtime = options_.require_realtime;
    o.driven = kept_.until_now();
    o.log = device_.log;
    player_ = std::make_unique<player>(std::move(s), environment_.tactors, o, lines_.lend(proof_s));
    player_->on_begin([this](stroke_id, std::optional<std::int64_t>) {
        begun_ = true;
        news_.signal();
    });
    player_->on_report([this](const stroke_report&) { news_.signal(); });
    setup_ = player_->setup();
    streams_ = true;
}

bool play_session::sleep(int fd, int timeout_ms, int also)
{
    pollfd fds[] = {{stop_.descriptor(), POLLIN, 0}, {fd, POLLIN, 0}, {also, POLLIN, 0}};
    ::poll(fds, 3, timeout_ms);
    if (const int s = stop_.poll())
        signal_ = s;
    return signal_ == 0;
}

void play_session::cancel()
{
    if (player_ != nullptr)
        player_->cancel(playing_);
}

player_position play_session::position() const
{
    return player_ != nullptr ? player_->position() : player_position{};
}

player_stats play_session::stats() const
{
    player_stats sum = before_;
    if (player_ != nullptr)
        add_stats(sum, player_->stats());
    return sum;
}

std::optional<stroke_report> play_session::submit(const score& s, start_at start)
{
    begun_ = false;
    try {
        playing_ = player_->submit(s, options_.arm ? start_at::trigger() : start);
    } catch (const error&) {
        const auto end = player_->ended();
        if (!end)
            throw;
        return stroke_report{.state = state_kind::interrupted, .reason = end->reason, .why = end->why};
    }
    return {};
}

stroke_report play_session::follow(const watcher& watch)
{
    for (;;) {
        if (const auto report = player_->wait(playing_, 0.0)) {
            // That the device is gone is told after the strokes that it interrupted.
            if (report->state == state_kind::interrupted)
                sleep(-1, settled_ms);
            return *report;
        }
        const player_position where = player_->position();
        if (watch)
            watch(where.stroke == playing_ ? &where : nullptr);
        if (!options_.arm || begun_)
            kept_.going(setup_.channels);
        const bool go_on = sleep(news_.fd(), watch ? frame_ms : kept_ms);
        news_.consume();
        if (!go_on) {
            player_->stop();
            return last_report(playing_);
        }
    }
}

stroke_report play_session::play(const score& s, const watcher& watch, start_at start)
{
    const auto ended = submit(s, start);
    return ended ? *ended : follow(watch);
}

stroke_report play_session::live(const live_options& o, point_source& points)
{
    live_stroke stroke = player_->begin(o);
    bool ended = false;
    bool begun = false;
    for (;;) {
        if (const auto report = player_->wait(stroke.id(), 0.0))
            return *report;
        try {
            while (const auto p = points.next()) {
                stroke.to(p->position.x_mm, p->position.y_mm, p->intensity);
                if (p->intensity > 1.0 && stroke.counts().held == 1)
                    points.warn_of_held(p->intensity);
                begun = true;
            }
        } catch (const error&) {
            stroke.cancel();
            player_->stop();
            throw;
        }
        if (points.over() && !std::exchange(ended, true))
            stroke.end();
        if (begun)
            kept_.going(setup_.channels);
        const bool go_on = sleep(news_.fd(), kept_ms, points.over() ? -1 : points.descriptor());
        news_.consume();
        if (!go_on) {
            player_->stop();
            return last_report(stroke.id());
        }
    }
}

// Of a stroke of a stream that was stopped.
stroke_report play_session::last_report(stroke_id id)
{
    const wait_result last = player_->wait(id);
    return last ? *last : stroke_report{.id = id, .state = state_kind::cancelled};
}

void play_session::close_player()
{
    if (player_ != nullptr) {
        add_stats(before_, player_->stats());
        end_stream();
    }
    player_.reset(); // it holds the device and borrows the lines
}

// Opens the device once, as soon as that is possible; false when it is to wait no longer.
bool play_session::try_again(const std::function<bool(double)>& pause)
{
    std::unique_ptr<sink> s = reopen_alsa(device_, pause);
    if (s == nullptr)
        return false;
    try {
        start(std::move(s), proof_ms * 1e-3);
    } catch (const error& e) {
        if (e.kind() == error_kind::bad_input)
            throw;
        return true;
    }
    return sleep(-1, proof_ms);
}

bool play_session::reopen()
{
    using clock = std::chrono::steady_clock;
    if (!waits() || may_be_on())
        return false;
    say(stderr, "tactor: waiting for \"{}\" to come back (Ctrl-C ends)\n", device_.pcm);
    const auto until = clock::now() + std::chrono::duration<double>(options_.reopen_s);
    // Opening proves little: each time that the device opens and then fails, the next pause is longer.
    double longest_yet_s = 0.0;
    const auto pause = [&](double wait_s) {
        const double left_s = std::chrono::duration<double>(until - clock::now()).count();
        longest_yet_s = std::max(wait_s, std::min(2.0 * longest_yet_s, longest_pause_s));
        return left_s > 0.0 && sleep(-1, static_cast<int>(std::ceil(std::min(longest_yet_s, left_s) * 1e3)));
    };
    do {
        close_player();
        if (!try_again(pause) || may_be_on())
            return false;
    } while (lost());
    ++reopened_;
    say(stderr, "tactor: \"{}\" is back\n", device_.pcm);
    return true;
}

run_facts play_session::finish()
{
    run_facts r{setup_, before_, reopened_, locked_};
    if (player_ != nullptr) {
        end_stream();
        r.device = player_->setup();
        add_stats(r.stats, player_->stats());
    }
    return r;
}

void play_session::end()
{
    const run_facts r = finish();
    warn_of_cuts(settle_limits(options_, environment_), r.stats);
    if (const auto on = left_on(r.stats))
        throw error(*on);
}

} // namespace tactor::session
