// SPDX-License-Identifier: MIT
#include "cli/play/play_options.hpp"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/commands.hpp"
#include "cli/input.hpp"
#include "cli/option_words.hpp"
#include "cli/play/live_lines.hpp"
#include "cli/play/play_report.hpp"
#include "cli/say.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {
namespace {

// Plays a stroke that lines move, until they end.
stroke_report follow_lines(session::play_session& session, const live_options& o, live_lines& lines)
{
    live_stroke stroke = session.begin(o);
    bool begun = false;
    bool ended = false;
    return session.follow([&] {
        while (const auto p = lines.next()) {
            stroke.to(p->position.x_mm, p->position.y_mm, p->intensity);
            if (p->intensity > 1.0 && stroke.counts().held == 1)
                lines.warn_of_held(p->intensity);
            begun = true;
        }
        if (lines.over() && !std::exchange(ended, true))
            stroke.end();
        return session::look{.descriptor = lines.over() ? -1 : lines.descriptor(), .drives = begun};
    });
}

} // namespace

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
    return hold_run(
        s, e, l.render.channels, l.render.rate, o.json(), {{"live"}},
        [&](session::play_session& session, std::vector<stroke_outcome>& outcomes) -> std::optional<error> {
            live_lines lines(STDIN_FILENO);
            stroke_outcome& out = outcomes.front();
            out.report = follow_lines(session, l, lines);
            out.length_frames = out.report->frames;
            tell(out, session.setup().rate, o.json());
            return {};
        });
}

} // namespace tactor::cli
