// SPDX-License-Identifier: MIT
#include "cli/play/play_session.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include <poll.h>
#include <unistd.h>

#include "cli/input.hpp"
#include "cli/play/instant.hpp"
#include "cli/play/own_memory.hpp"
#include "cli/play/sound_server.hpp"
#include "cli/say.hpp"
#include "rt/advice.hpp"

namespace tactor::cli {
namespace {

constexpr int frame_ms = 40;   // of the picture: 25 a second
constexpr int settled_ms = 10; // more than one turn of the audio thread takes
constexpr int kept_ms = 1000;  // how often it is kept that the array is driven
constexpr int proof_ms = 1000; // a device that was lost is back when it has held for so long
constexpr double longest_pause_s = 5.0;

} // namespace

play_session::play_session(const alsa_options& device, const play_options& o, const environment& e,
                           stream_source source)
    : options_(o),
      environment_(e),
      source_(std::move(source)),
      lines_(o.no_gpio ? tactor::setup{} : e.config, o.arm, o.sync_delay_ms * 1e-3),
      log_(o.verbose, o.log),
      device_(device),
      kept_(device.pcm, limits_of(o, e))
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
    o.limits = limits_of(options_, environment_);
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

stroke_report play_session::play(const piece& p, const score& s, const watcher& watch, start_at start)
{
    live_picture picture(environment_.tactors,
                         !watch && !options_.json() && !options_.verbose); // whose lines would run through it
    std::optional<piece_follower> follower;
    if (picture.active())
        follower.emplace(p, s, environment_.tactors);
    const double total = static_cast<double>(s.frames()) / s.rate();
    stroke_id id = {};
    begun_ = false;
    try {
        id = player_->submit(s, options_.arm ? start_at::trigger() : start);
        playing_ = id;
    } catch (const error&) {
        const auto end = player_->ended();
        if (!end)
            throw;
        return {.state = state_kind::interrupted, .reason = end->reason, .why = end->why};
    }
    if (options_.arm && !options_.json()) {
        say(stdout, "{}: armed\n", shown_name(p.name));
        flush_output();
    }
    double t = 0.0; // stays where it was while the report of the stroke's end is on its way
    for (;;) {
        if (const auto report = player_->wait(id, 0.0)) {
            // That the device is gone is told after the strokes that it interrupted.
            if (report->state == state_kind::interrupted)
                sleep(-1, settled_ms);
            return *report;
        }
        const player_position where = player_->position();
        if (where.stroke == id) {
            t = static_cast<double>(where.stroke_frame) / s.rate();
            if (watch)
                watch(where);
        }
        if (follower)
            picture.draw(follower->at(t), t, total);
        if (!options_.arm || begun_)
            kept_.going(setup_.channels);
        const bool go_on = sleep(news_.fd(), picture.active() || watch ? frame_ms : kept_ms);
        news_.consume();
        if (!go_on) {
            player_->stop();
            return end_of(id);
        }
    }
}

stroke_report play_session::live(const live_options& o, live_lines& lines)
{
    live_stroke stroke = player_->begin(o);
    bool ended = false;
    bool begun = false;
    for (;;) {
        if (const auto report = player_->wait(stroke.id(), 0.0))
            return *report;
        try {
            while (const auto p = lines.next()) {
                stroke.to(p->position.x_mm, p->position.y_mm, p->intensity);
                if (p->intensity > 1.0 && stroke.counts().held == 1)
                    lines.warn_of_held(p->intensity);
                begun = true;
            }
        } catch (const error&) {
            stroke.cancel();
            player_->stop();
            throw;
        }
        if (lines.over() && !std::exchange(ended, true))
            stroke.end();
        if (begun)
            kept_.going(setup_.channels);
        const bool go_on = sleep(news_.fd(), kept_ms, lines.over() ? -1 : lines.descriptor());
        news_.consume();
        if (!go_on) {
            player_->stop();
            return end_of(stroke.id());
        }
    }
}

// Of a stroke of a stream that was stopped.
stroke_report play_session::end_of(stroke_id id)
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

void play_session::finish(run_report& r)
{
    r.device = setup_;
    r.stats = before_;
    if (player_ != nullptr) {
        end_stream();
        r.device = player_->setup();
        add_stats(r.stats, player_->stats());
    }
    r.reopened = reopened_;
    r.locked_memory = locked_;
}

std::optional<int> tell_end(const play_session& session, const play_options& o, const environment& e,
                            const run_report& r)
{
    warn_of_cuts(limits_of(o, e), r.stats);
    if (o.json())
        print_json(stdout, r);
    else
        print_table(stdout, r);
    if (const auto on = left_on(r.stats))
        throw error(*on);
    if (session.signal() != 0)
        return interrupt::status(session.signal());
    return std::nullopt;
}

} // namespace tactor::cli
