// SPDX-License-Identifier: MIT
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "cli/input.hpp"
#include "cli/play/live_lines.hpp"
#include "cli/play/live_picture.hpp"
#include "cli/play/play_report.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "session/environment.hpp"
#include "session/live_remarks.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {
namespace {

std::vector<score> make_scores(std::vector<piece>& pieces, const settings& s, const environment& e,
                               const layout& faces, const render_options& render)
{
    std::vector<score> scores;
    std::vector<std::string> warnings;
    for (piece& p : pieces) {
        scores.push_back(plan_and_score(p, s, e, faces, render));
        for (std::string& w : collect_warnings(scores.back().plans()))
            warnings.push_back(std::move(w));
    }
    say_warnings(warnings);
    session::tell_of_other_carrier(e, render, scores);
    return scores;
}

constexpr int max_strokes = 10000; // on one command line
constexpr const char* wait_hint = "--reopen-s S waits for the device to come back";

// Plays a piece, once again if the device went away before it began, and reports when it waits for its
// trigger. Returns false if there is no device.
bool play_piece(session::play_session& session, bool as_json, const array& a, const piece& p, const score& s,
                stroke_outcome& out)
{
    for (bool again = false;; again = true) {
        if (session.lost() && !session.reopen())
            return false;
        out.report = session.submit(s);
        if (!out.report && session.asked().arm && !as_json) {
            say(stdout, "{}: armed\n", shown_name(p.name));
            flush_output();
        }
        // No picture with --verbose: it would overwrite log lines.
        if (!out.report)
            out.report = follow_drawn(session, a, p, s, !as_json && !session.asked().verbose);
        const bool untouched =
            out.report->state == state_kind::interrupted && out.report->frames == 0 && session.lost();
        if (!untouched || again || !session.waits())
            return true;
    }
}

// Returns the error that ends the run with this stroke, if any. The end of the last stroke is reported later.
std::optional<error> judge(const session::play_session& session, const stroke_outcome& out, bool last)
{
    if (out.report->state != state_kind::interrupted)
        return {};
    const auto broken = [&](const char* hint) {
        return error(error_kind::runtime, shown_name(out.name), fate(out, session.setup().rate), hint);
    };
    if (session.asked().void_on_xrun)
        return broken("the run is void: --void-on-xrun");
    if (last)
        return {};
    if (session.lost() && !session.waits())
        return broken(wait_hint);
    say(stderr, "tactor: warning: {}\n", describe(out, session.setup().rate));
    return {};
}

std::optional<error> play_all(session::play_session& session, bool as_json, const array& a,
                              const std::vector<piece>& pieces, const std::vector<score>& scores,
                              std::vector<stroke_outcome>& outcomes)
{
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const bool there = play_piece(session, as_json, a, pieces[i], scores[i], outcomes[i]);
        if (!there && session.signal() == 0)
            return error(error_kind::runtime, shown_name(pieces[i].name), "not played: the device is gone",
                         session.waits() ? "it did not come back in time" : wait_hint);
        session.log_end(shown_name(pieces[i].name), *outcomes[i].report);
        tell(outcomes[i], session.setup().rate, as_json);
        if (session.signal() != 0)
            return {};
        if (auto broken = judge(session, outcomes[i], i + 1 == pieces.size()))
            return broken;
    }
    return {};
}

// Plays a stroke that lines move, until they end.
stroke_report follow_lines(session::play_session& session, const live_options& o, live_lines& lines)
{
    live_stroke stroke = session.begin(o);
    session::live_remarks remarks(lines.intensity_max());
    bool ended = false;
    return session.follow([&] {
        while (const auto p = lines.next()) {
            stroke.to(p->position.x_mm, p->position.y_mm, p->intensity);
            for (const std::string& remark : remarks.take(stroke, p->position, p->intensity))
                lines.warn(remark);
        }
        if (lines.over() && !std::exchange(ended, true))
            stroke.end();
        return session::look{.descriptor = lines.over() ? -1 : lines.descriptor()};
    });
}

// Refuses options that a live stroke does not have.
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

// Plays until standard input ends.
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
            live_lines lines(STDIN_FILENO, s.intensity_max.value_or(1.0));
            stroke_outcome& out = outcomes.front();
            out.report = follow_lines(session, l, lines);
            out.length_frames = out.report->frames;
            session.log_end(out.name, *out.report);
            tell(out, session.setup().rate, o.json());
            return {};
        });
}

int play(settings& s, const play_options& o)
{
    if (s.stream.live)
        check_live(s);
    else if (s.stream.smooth_s)
        throw error(error_kind::bad_input, "--smooth", "only points that come one by one are smoothed",
                    "use it with --live, or leave it out");
    if (o.socket)
        return play_remote(s, o);
    if (s.stream.live)
        return play_live(s, o);
    const environment e = session::read_environment(s);
    const layout faces(e.tactors);
    std::vector<piece> pieces;
    for (const std::string& argument : stroke_arguments(s))
        pieces.push_back(open_piece(s, e, faces, argument));
    const auto scores = make_scores(pieces, s, e, faces, session::settle_render(s, e));
    std::vector<stroke_outcome> strokes;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        strokes.push_back({pieces[i].name, scores[i].frames()});
    return hold_run(s, e, scores.front().channels(), scores.front().rate(), o.json(), std::move(strokes),
                    [&](session::play_session& session, std::vector<stroke_outcome>& outcomes) {
                        return play_all(session, o.json(), e.tactors, pieces, scores, outcomes);
                    });
}

} // namespace

int run_play(command_line& line)
{
    play_options o;
    add_strokes(line, max_strokes);
    settings& s = add_options(line, options::on_play);
    line.app.add_option("--socket", o.socket, "play through the server at this socket")->type_name("PATH");
    add_format_option(line.app, o.format, {"text", "json"}, "format of the report (default text)");
    line.app.footer("tactor play park2016-3 -D hw:CARD=Tactor --level-dbfs -40\n"
                    "tactor play --shape circle --duration 2 --level-dbfs -20 -D null\n"
                    "tactor play park2016-1 park2016-3 --log play.log -D null");
    line.parse();
    return play(s, o);
}

} // namespace tactor::cli
