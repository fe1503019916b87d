// SPDX-License-Identifier: MIT
#include <cerrno>
#include <cstring>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "cli/commands.hpp"
#include "cli/input.hpp"
#include "cli/interrupt.hpp"
#include "cli/live_picture.hpp"

namespace tactor::cli {
namespace {

constexpr int frame_ms = 40; // of the picture: 25 a second

alsa_options device(const settings& s, const environment& e, const score& first)
{
    alsa_options o;
    const output_settings& out = e.config.output;
    if (s.pcm || out.pcm)
        o.pcm = s.pcm ? *s.pcm : *out.pcm;
    else
        fmt::print(stderr,
                   "tactor: no device is configured: playing to \"null\", which nobody feels (-D PCM plays "
                   "on hardware)\n");
    o.channels = first.channels();
    o.rate = first.rate();
    o.format = s.format;
    o.period_frames = out.period_frames.value_or(o.period_frames);
    o.periods = out.periods.value_or(o.periods);
    return o;
}

// Wakes the main thread when a stroke has ended.
class ended_signal {
public:
    ended_signal() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC))
    {
        if (fd_ < 0)
            throw error(errc::runtime, "eventfd", std::strerror(errno));
    }
    ~ended_signal() { close(fd_); }
    ended_signal(const ended_signal&) = delete;
    ended_signal& operator=(const ended_signal&) = delete;

    void raise() const { [[maybe_unused]] const int r = eventfd_write(fd_, 1); }
    int descriptor() const { return fd_; }
    void clear() const
    {
        eventfd_t ignored;
        [[maybe_unused]] const int r = eventfd_read(fd_, &ignored);
    }

private:
    int fd_;
};

std::vector<double> starts_s(const score& s)
{
    std::vector<double> starts;
    for (std::uint64_t f : s.starts())
        starts.push_back(static_cast<double>(f) / s.rate());
    return starts;
}

// Plays one piece; returns the signal that stopped it, or 0.
int play_piece(player& device, const piece& p, const score& s, const environment& e, interrupt& stop,
               const ended_signal& ended)
{
    live_picture picture(e.tactors);
    const auto starts = starts_s(s);
    const double total = static_cast<double>(s.frames()) / s.rate();
    const stroke_id id = device.submit(s);
    for (;;) {
        if (const auto report = device.wait(id, std::chrono::nanoseconds(0))) {
            if (report->state == stroke_state::interrupted)
                throw error(errc::runtime, p.name,
                            fmt::format("interrupted after {:.3f} s: {}",
                                        static_cast<double>(report->frames) / s.rate(), report->reason));
            return 0;
        }
        const player_position where = device.position();
        const double t = where.stroke == id ? static_cast<double>(where.stroke_frame) / s.rate() : 0.0;
        if (picture.active())
            picture.draw(at_time(p.plans, starts, e.tactors.tactors.size(), t), t, total);
        pollfd fds[] = {{stop.descriptor(), POLLIN, 0}, {ended.descriptor(), POLLIN, 0}};
        ::poll(fds, 2, picture.active() ? frame_ms : -1);
        ended.clear();
        if (const int signal = stop.poll())
            return signal;
    }
}

int play(settings& s, option_list& options)
{
    const environment e = read_environment(s, options);
    const auto pieces = plan_pieces(s, e);
    const render_options render = settle_render(s, e);
    std::vector<score> scores;
    for (const piece& p : pieces) {
        scores.push_back(make_score(p, e, render));
        for (const placed_plan& q : p.plans)
            for (const std::string& w : q.schedule.warnings)
                fmt::print(stderr, "tactor: warning: {}\n", w);
    }
    interrupt stop;
    const ended_signal ended;
    player device_player(open_alsa(device(s, e, scores.front())), e.tactors);
    device_player.on_report([&ended](const stroke_report&) { ended.raise(); });
    const stream_setup& out = device_player.setup();
    fmt::print("{}: {} channels, {} Hz, {}, period {} of {} frames\n", out.name, out.channels, out.rate,
               to_string(out.format), out.period_frames, out.buffer_frames);
    std::fflush(stdout);
    int signal = 0;
    for (std::size_t i = 0; i < pieces.size() && signal == 0; ++i) {
        signal = play_piece(device_player, pieces[i], scores[i], e, stop, ended);
        if (signal == 0)
            fmt::print("{}: played {:.3f} s\n", pieces[i].name,
                       static_cast<double>(scores[i].frames()) / scores[i].rate());
    }
    device_player.stop();
    return signal == 0 ? status_ok : interrupt::status(signal);
}

} // namespace

command add_play(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("play", "Play on the array");
    auto s = std::make_shared<settings>();
    auto options = std::make_shared<option_list>(*c, *s);
    options->add_stroke_options();
    options->add_sound_options();
    options->add_device_options();
    c->footer("Example: tactor play park2016-3 -D hw:CARD=Tactor");
    return [s, options] { return play(*s, *options); };
}

} // namespace tactor::cli
