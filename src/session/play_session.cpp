// SPDX-License-Identifier: MIT
#include "session/play_session.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <utility>

#include <poll.h>

#include "core/log.hpp"
#include "core/words.hpp"
#include "session/device.hpp"
#include "session/process.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

constexpr int turn_ms = 10; // longer than one turn of the audio thread
constexpr int longest_ms = 60'000;

int milliseconds_until(std::optional<device_stream::time> t, int most_ms)
{
    using std::chrono::milliseconds;
    const auto remaining = std::chrono::ceil<milliseconds>(t.value_or(device_stream::time::max()) -
                                                           device_stream::time::clock::now());
    return static_cast<int>(std::clamp(remaining, milliseconds(0), milliseconds(most_ms)).count());
}

} // namespace

void run_facts::check_amplifier() const
{
    if (stats.left_on)
        throw error(
            error_kind::not_available, "amplifier",
            fmt::format("its line cannot be switched off, so it may be on after {}",
                        counted(stats.off_failures, "failed try", "failed tries")),
            "cut the amplifier's supply, then look for the cause with \"{command:off}\" and in dmesg");
}

play_session::play_session(const alsa_options& device, const stream_options& o, const environment& e,
                           const stream_source& adapt)
    : options_(o),
      environment_(e),
      pcm_(device.pcm),
      log_(o.verbose, o.log),
      stream_(make_parts(device, adapt))
{
    stream_.step();
    stream_.run_work();
    if (stream_.failure() != nullptr)
        std::rethrow_exception(stream_.failure());
    for (const device_note& n : wiring_notes(environment_.tactors, setup()))
        say(stderr, "tactor: warning: {} ({})\n", n.text, n.cure);
    warn_of_missing_rights(stats().realtime, locked_);
}

stream_parts play_session::make_parts(alsa_options device, const stream_source& adapt)
{
    device.log = log_.function();
    stream_parts p = open_parts(device, options_, environment_, options_.arm);
    p.times.wait_s = options_.reopen_s;
    if (adapt)
        adapt(p);
    p.open = [this, open = std::move(p.open), log = device.log, first = true]() mutable {
        std::unique_ptr<sink> s = open();
        if (std::exchange(first, false))
            locked_ = prepare_realtime(options_.require_realtime);
        else
            detail::log(log, log_kind::info, "PCM \"{}\" is back", pcm_);
        return s;
    };
    return p;
}

bool play_session::wait_for(int descriptor, int timeout_ms, int also)
{
    pollfd fds[] = {{stop_.descriptor(), POLLIN, 0}, {descriptor, POLLIN, 0}, {also, POLLIN, 0}};
    ::poll(fds, 3, timeout_ms);
    if (const int s = stop_.poll())
        signal_ = s;
    return signal_ == 0;
}

void play_session::cancel()
{
    if (stream_.current() != nullptr)
        stream_.current()->cancel(playing_);
}

void play_session::log_end(std::string_view name, const stroke_report& r)
{
    detail::log(log_.function(), log_kind::info, "{}", stroke_text(name, r, setup().rate));
}

player_position play_session::position() const
{
    return stream_.current() != nullptr ? stream_.current()->position() : player_position{};
}

std::vector<double> play_session::drive_levels_s() const
{
    return stream_.current() != nullptr ? stream_.current()->drive_levels_s() : std::vector<double>{};
}

std::optional<stroke_report> play_session::submit(const score& s, start_at start)
{
    player& p = *stream_.current();
    if (followed_by_) {
        playing_ = *std::exchange(followed_by_, {});
        return {};
    }
    if (const auto id = hand_over(s, options_.arm ? start_at::trigger() : start)) {
        playing_ = *id;
        return {};
    }
    const stream_end end = *p.ended();
    return stroke_report{.state = state_kind::interrupted, .reason = end.reason, .why = end.why};
}

std::optional<stroke_id> play_session::hand_over(const score& s, start_at start)
{
    player& p = *stream_.current();
    try {
        return p.submit(s, start);
    } catch (const error&) {
        if (!p.ended())
            throw;
        return {};
    }
}

void play_session::queue_next(const score* s, std::uint64_t frames) noexcept
{
    follower_ = s;
    follows_after_ = frames;
}

void play_session::submit_follower(std::optional<std::uint64_t> first)
{
    if (follower_ != nullptr && first)
        followed_by_ =
            hand_over(*std::exchange(follower_, nullptr), start_at::frame(*first + follows_after_));
}

live_stroke play_session::begin(const live_options& o)
{
    live_stroke s = stream_.current()->begin(o);
    playing_ = s.id();
    return s;
}

std::optional<std::uint64_t> play_session::stroke_frame() const
{
    const player_position where = position();
    return where.stroke == playing_ ? std::optional(where.stroke_frame) : std::nullopt;
}

stroke_report play_session::follow(const std::function<look()>& each)
{
    player& p = *stream_.current();
    for (;;) {
        if (const auto report = p.wait(playing_, std::chrono::seconds(0))) {
            // The report about a lost device comes after the reports of the strokes that it interrupted.
            if (report->state == state_kind::interrupted)
                wait_for(-1, turn_ms);
            submit_follower(report->first_frame); // the stroke may have begun and ended since the last look
            return *report;
        }
        submit_follower(p.first_frame(playing_));
        const look l = each ? each() : look{};
        const bool go_on =
            wait_for(stream_.descriptor(), milliseconds_until(stream_.step(), l.most_ms), l.descriptor);
        stream_.take_news();
        if (!go_on) {
            p.stop();
            const wait_result last = p.wait(playing_);
            return last ? *last : stroke_report{.id = playing_, .state = state_kind::cancelled};
        }
    }
}

void play_session::check_failure()
try {
    if (stream_.failure() != nullptr)
        std::rethrow_exception(stream_.failure());
} catch (const error& e) {
    if (e.kind() == error_kind::bad_input)
        throw;
    detail::log(log_.function(), log_kind::debug, "not back yet: {}", e.what());
}

bool play_session::reopen()
{
    if (!waits())
        return false;
    followed_by_.reset(); // belonged to the stream that ended
    for (bool announced = false;;) {
        const auto again = stream_.step();
        if (stream_.is_over())
            return false;
        if (stream_.state() == stream_state::running)
            break;
        if (stream_.run_work()) {
            check_failure();
            continue;
        }
        if (!std::exchange(announced, true)) {
            say(stderr, "tactor: waiting for \"{}\" to come back (Ctrl-C ends)\n", pcm_);
            detail::log(log_.function(), log_kind::info, "waiting for PCM \"{}\" to come back", pcm_);
        }
        if (!wait_for(stream_.descriptor(), milliseconds_until(again, longest_ms)))
            return false;
        stream_.take_news();
    }
    ++reopened_;
    say(stderr, "tactor: \"{}\" is back\n", pcm_);
    return true;
}

run_facts play_session::finish()
{
    stream_.finish();
    run_facts r{setup(), stats(), reopened_, locked_};
    const drive_limits l = find_limits(options_, environment_);
    if (r.stats.drives_cut != 0)
        say(stderr,
            "tactor: warning: {} cut short or silent, because a tactor may vibrate for {} s in {} s (wait "
            "{:.4g} s before the next stroke, or change max_drive_s in [limits])\n",
            r.stats.drives_cut == 1 ? "1 drive was" : fmt::format("{} drives were", r.stats.drives_cut),
            l.max_drive_s, l.window_s, l.window_s - l.max_drive_s);
    return r;
}

} // namespace tactor::session
