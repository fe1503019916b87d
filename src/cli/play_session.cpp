// SPDX-License-Identifier: MIT
#include "cli/play_session.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "cli/own_memory.hpp"
#include "cli/say.hpp"

namespace tactor::cli {
namespace {

constexpr int frame_ms = 40;   // of the picture: 25 a second
constexpr int settled_ms = 10; // more than one turn of the audio thread takes

std::vector<double> starts_s(const score& s)
{
    std::vector<double> starts;
    for (std::uint64_t f : s.starts())
        starts.push_back(static_cast<double>(f) / s.rate());
    return starts;
}

} // namespace

ended_signal::ended_signal() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC))
{
    if (fd_ < 0)
        throw error(errc::runtime, "eventfd", std::strerror(errno));
}

ended_signal::~ended_signal()
{
    close(fd_);
}

void ended_signal::raise() const noexcept
{
    [[maybe_unused]] const int r = eventfd_write(fd_, 1);
}

void ended_signal::clear() const noexcept
{
    eventfd_t ignored = 0;
    [[maybe_unused]] const int r = eventfd_read(fd_, &ignored);
}

play_session::play_session(const alsa_options& device, const play_options& o, const environment& e)
    : options_(o),
      environment_(e),
      lines_(o.no_gpio ? tactor::setup{} : e.config, o.arm, o.sync_delay_ms * 1e-3),
      device_(device)
{
    std::unique_ptr<sink> s = open_alsa(device_);
    limit_runaway_threads();
    const std::string refused = lock_own_memory();
    locked_ = refused.empty();
    const player_options defaults;
    const auto advice = [&] { return realtime_advice(probe_realtime_rights(), defaults.priority); };
    if (!locked_ && o.require_realtime)
        throw error(errc::not_available, "locked memory", refused, advice());
    start(std::move(s));
    const bool realtime = player_->stats().realtime;
    if (!realtime || !locked_)
        say(stderr, "tactor: warning: {}{}{}: xruns are likelier ({})\n",
            realtime ? "" : "no real-time priority", realtime || locked_ ? "" : ", ",
            locked_ ? "" : fmt::format("memory is not locked ({})", refused), advice());
}

void play_session::start(std::unique_ptr<sink> s)
{
    player_options o;
    o.limits = limits_of(options_, environment_);
    o.require_realtime = options_.require_realtime;
    o.driven = driven_;
    player_ = std::make_unique<player>(std::move(s), environment_.tactors, o, lines_.lend());
    player_->on_report([this](const stroke_report&) { ended_.raise(); });
    setup_ = player_->setup();
}

bool play_session::sleep(int fd, int timeout_ms)
{
    pollfd fds[] = {{stop_.descriptor(), POLLIN, 0}, {fd, POLLIN, 0}};
    ::poll(fds, 2, timeout_ms);
    if (const int s = stop_.poll())
        signal_ = s;
    return signal_ == 0;
}

stroke_report play_session::play(const piece& p, const score& s)
{
    live_picture picture(environment_.tactors, !options_.json());
    const auto starts = starts_s(s);
    const double total = static_cast<double>(s.frames()) / s.rate();
    stroke_id id = 0;
    try {
        id = player_->submit(s, options_.arm ? start_at::trigger() : start_at::now());
    } catch (const error&) {
        if (!lost())
            throw;
        return {.state = stroke_state::interrupted, .reason = *player_->ended()};
    }
    if (options_.arm && !options_.json()) {
        say(stdout, "{}: armed\n", p.name);
        std::fflush(stdout);
    }
    double t = 0.0; // stays where it was while the report of the stroke's end is on its way
    for (;;) {
        if (const auto report = player_->wait(id, std::chrono::nanoseconds(0))) {
            // That the device is gone is told after the strokes that it interrupted.
            if (report->state == stroke_state::interrupted)
                sleep(-1, settled_ms);
            return *report;
        }
        const player_position where = player_->position();
        if (where.stroke == id)
            t = static_cast<double>(where.stroke_frame) / s.rate();
        if (picture.active())
            picture.draw(at_time(s.plans(), starts, environment_.tactors.tactors.size(), t), t, total);
        const bool go_on = sleep(ended_.descriptor(), picture.active() ? frame_ms : -1);
        ended_.clear();
        if (!go_on) {
            player_->stop();
            return player_->wait(id).value_or(stroke_report{.id = id, .state = stroke_state::cancelled});
        }
    }
}

bool play_session::reopen()
{
    using clock = std::chrono::steady_clock;
    // With an amplifier that may be on there is nothing to wait for: the run ends, and says so.
    if (!waits() || (player_ != nullptr && player_->stats().left_on))
        return false;
    say(stderr, "tactor: waiting for \"{}\" to come back (Ctrl-C ends)\n", device_.pcm);
    if (player_ != nullptr) {
        add_stats(before_, player_->stats());
        player_->stop();
        driven_ = player_->history();
    }
    const auto until = clock::now() + std::chrono::duration<double>(options_.reopen_s);
    const auto pause = [&](std::chrono::milliseconds wait) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - clock::now());
        return left.count() > 0 && sleep(-1, static_cast<int>(std::min(wait, left).count()));
    };
    // The old stream holds the device and borrows the lines.
    player_.reset();
    while (player_ == nullptr) {
        std::unique_ptr<sink> s = reopen_alsa(device_, pause);
        if (s == nullptr)
            return false;
        try {
            start(std::move(s));
        } catch (const error& e) {
            if (e.kind() == errc::bad_input)
                throw;
        }
    }
    ++reopened_;
    say(stderr, "tactor: \"{}\" is back\n", device_.pcm);
    return true;
}

void play_session::finish(run_report& r)
{
    r.device = setup_;
    r.stats = before_;
    if (player_ != nullptr) {
        player_->stop();
        r.device = player_->setup();
        add_stats(r.stats, player_->stats());
    }
    r.reopened = reopened_;
    r.locked_memory = locked_;
}

} // namespace tactor::cli
