// SPDX-License-Identifier: MIT
#include "cli/play/play_options.hpp"

#include <unistd.h>

#include "cli/commands.hpp"
#include "cli/input.hpp"
#include "cli/option_words.hpp"
#include "cli/play/live_lines.hpp"
#include "cli/play/play_report.hpp"
#include "cli/say.hpp"
#include "session/play_session.hpp"
#include "session/sound_server.hpp"

namespace tactor::cli {

void check_live(const settings& s)
{
    if (s.strokes.size() != 1 || s.strokes.front() != "-" || s.path_data)
        throw error(error_kind::bad_input, "--live", "it takes its points from standard input",
                    "give - as the only STROKE: tactor play --live -");
    for (const options::option& o : options::all())
        if ((o.where & options::planning) != 0 && (o.where & options::live) == 0 && s.gives(o))
            throw error(error_kind::bad_input, option_name(o), "a live stroke does not know it",
                        "its points say when it is where");
    if (s.stream.arm)
        throw error(error_kind::bad_input, "--arm", "a live stroke starts with its first point",
                    "leave it out");
}

int play_live(settings& s, const play_options& o)
{
    s.strokes.clear(); // standard input has its points, which come later
    const environment e = session::read_environment(s);
    const live_options usual;
    live_options l;
    l.plan = s.plan;
    if (!s.gives("algorithm"))
        l.plan.algorithm = usual.plan.algorithm;
    if (!s.gives("outside"))
        l.plan.outside = usual.plan.outside;
    l.render = session::settle_render(s, e);
    l.timeout_s = live_timeout_s;
    l.smooth_s = s.stream.smooth_s.value_or(l.smooth_s);
    if (!session::names_device(s, e))
        say(stderr, "tactor: no device is configured: playing to \"null\", which nobody feels (-D PCM plays "
                    "on hardware)\n");
    const alsa_options device = session::device_options(s, s.stream, e, l.render.channels, l.render.rate);
    const std::string between = session::settle_server(device.pcm);
    if (!between.empty())
        say(stderr, "tactor: warning: {} ({})\n", session::server_note(between), session::server_cure);
    session::play_session session(device, s.stream, e);
    if (!o.json())
        say(stdout, "{}\n", describe(session.setup()));
    flush_output();
    live_lines lines(STDIN_FILENO);
    run_report r;
    r.strokes.push_back({"live"});
    stroke_outcome& out = r.strokes.front();
    out.report = session.live(l, lines);
    out.length_frames = out.report->frames;
    if (!o.json())
        say(stdout, "{}\n", describe(out, session.setup().rate));
    static_cast<session::run_facts&>(r) = session.finish();
    if (const auto status = tell_end(session, o.json(), e, r))
        return *status;
    if (const auto left = unfinished(r))
        throw error(*left);
    return status_ok;
}

} // namespace tactor::cli
