// SPDX-License-Identifier: MIT
#include "cli/play/play.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <poll.h>
#include <tactor/error.hpp>
#include <unistd.h>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"
#include "session/device.hpp"
#include "session/environment.hpp"
#include "session/live_remarks.hpp"
#include "session/play_session.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

constexpr std::size_t longest_line = 4096;
constexpr double farthest_mm = 1e6;
constexpr const char* point_hint =
    "write x y [intensity], such as 20 12.5 0.8, with x and y in mm and intensity from 0 to 1";

// Splits a line at blanks, and a comma with a blank after it. Other commas may be decimal commas.
std::vector<std::string_view> split(std::string_view line)
{
    std::vector<std::string_view> words;
    constexpr const char* blanks = " \t\r";
    bool comma = true; // no second comma follows one, and none begins a line
    for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
        std::string_view word = line.substr(at, end - at);
        at = line.find_first_not_of(blanks, end);
        const bool separates = at != std::string_view::npos && word.ends_with(',') && !(comma && word == ",");
        if (separates)
            word.remove_suffix(1);
        if (!word.empty())
            words.push_back(word);
        comma = separates;
    }
    return words;
}

// Parses a number. Accepts nan and a leading +.
std::optional<double> read_number(std::string_view word)
{
    if (word.starts_with('+') && !word.starts_with("+-"))
        word.remove_prefix(1);
    return detail::parse_number_text<double>(word);
}

source_place line_place(std::size_t line)
{
    return {.file = "standard input", .line = static_cast<unsigned>(line)};
}

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
    print_grouped_warnings(warnings);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        warn_of_weakening(shown_name(pieces[i].name), scores[i].weakened(), scores[i].plans().size());
    session::warn_of_other_carrier(e, render, scores);
    return scores;
}

constexpr int max_strokes = 10000; // greatest number on one command line
constexpr const char* wait_hint = "use --reopen-s S to wait for the device";

// Plays a piece. If the device is lost before the piece begins, tries again once. Prints a message if the
// piece waits for its trigger. Returns false if there is no device.
bool play_piece(session::play_session& session, bool as_json, const array& a, const piece& p, const score& s,
                stroke_outcome& out)
{
    for (bool again = false;; again = true) {
        if (session.lost() && !session.reopen())
            return false;
        out.report = session.submit(s);
        if (!out.report && session.run_options().arm && !as_json) {
            say(stdout, "{}: armed\n", shown_name(p.name));
            flush_output();
        }
        // With --verbose there is no picture, because it would overwrite log lines.
        if (!out.report)
            out.report = follow_and_draw(session, a, p, s, !as_json && !session.run_options().verbose);
        const bool untouched =
            out.report->state == state_kind::interrupted && out.report->frames == 0 && session.lost();
        if (!untouched || again || !session.waits())
            return true;
    }
}

// Returns an error if the run must end after this stroke. For the last stroke, returns one only with
// --void-on-xrun; play_and_report() reports other ends of the last stroke.
std::optional<error> find_run_error(const session::play_session& session, const stroke_outcome& out,
                                    bool last)
{
    if (out.report->state != state_kind::interrupted)
        return {};
    const auto broken = [&](const char* hint) {
        return error(error_kind::runtime, shown_name(out.name), outcome_text(out, session.setup().rate),
                     hint);
    };
    if (session.run_options().void_on_xrun)
        return broken("repeat the run: --void-on-xrun made it void");
    if (last)
        return {};
    if (session.lost() && !session.waits())
        return broken(wait_hint);
    say(stderr, "tactor: warning: {}\n", describe(out, session.setup().rate));
    return {};
}

std::optional<error> play_all(session::play_session& session, const play_options& o, const array& a,
                              const std::vector<piece>& pieces, const std::vector<score>& scores,
                              std::vector<stroke_outcome>& outcomes)
{
    for (std::size_t i = 0; i < pieces.size(); ++i)
        outcomes.push_back({pieces[i].name, scores[i].frames(), {}, scores[i].weakened(), 0});
    const auto pause = static_cast<std::uint64_t>(std::llround(o.pause_s * session.setup().rate));
    const std::uint64_t all = o.rounds == 0 ? ~std::uint64_t{0} : o.rounds * pieces.size();
    for (std::uint64_t k = 0; k < all; ++k) {
        const std::size_t i = k % pieces.size();
        const bool followed = o.rounds != 1 && k + 1 < all && !session.run_options().arm;
        session.queue_next(followed ? &scores[(k + 1) % pieces.size()] : nullptr, scores[i].frames() + pause);
        stroke_outcome round{pieces[i].name, scores[i].frames(), {}, scores[i].weakened(), 1};
        const bool has_device = play_piece(session, o.json(), a, pieces[i], scores[i], round);
        if (!has_device && session.signal() == 0)
            return error(error_kind::runtime, shown_name(pieces[i].name), "not played: the device is gone",
                         session.waits() ? "use a longer --reopen-s" : wait_hint);
        if (!round.report) // a signal arrived while it waited for the device
            return {};
        session.log_end(shown_name(pieces[i].name), *round.report);
        print_outcome(round, session.setup().rate, o.json());
        add_report(outcomes[i].report, *round.report);
        *outcomes[i].rounds += 1;
        if (session.signal() != 0)
            return {};
        if (auto broken = find_run_error(session, round, k + 1 == all))
            return broken;
    }
    return {};
}

// Parses the number of rounds. Returns 0 for "forever".
std::uint64_t parse_rounds(const std::string& text)
{
    constexpr double most_rounds = 1e6; // the server has the same limit
    constexpr const char* range = "1 to 1000000, or forever";
    if (text == "forever")
        return 0;
    const double n = options::parse_number("--repeat", text, {1.0, most_rounds}, "", range);
    if (n != std::floor(n))
        refuse_option("--repeat", fmt::format("{} is not a whole number", text),
                      fmt::format("use {}", range));
    return static_cast<std::uint64_t>(n);
}

void check_rounds(const settings& s, const play_options& o)
{
    if (o.rounds == 1 && o.pause_s > 0.0)
        refuse_option("--pause", "there is only one round to play", "add --repeat N or --repeat forever");
    if (s.stream.arm && o.pause_s > 0.0)
        refuse_option("--pause", "it has no effect with --arm, where each round waits for its own edge",
                      "leave out --pause or --arm");
    if (o.rounds != 1 && s.stream.live)
        refuse_option("--repeat", "a live stroke cannot be repeated", "leave out --repeat");
    if (o.rounds != 1 && o.socket && s.strokes.size() > 1)
        refuse_option("--repeat", "a server can repeat only one STROKE argument",
                      "put the strokes into one file");
}

// Opens the device with `channels` channels at `rate` Hz, calls play(session, report.strokes), closes the
// device and prints the report. If play() returns an error, the run ended early because of it. Returns the
// exit status. \throws error; if the amplifier may still be on, the error says so.
template <class F>
int play_and_report(const settings& s, const environment& e, unsigned channels, unsigned rate,
                    const play_options& o, F play)
{
    session::report_missing_device(s, e);
    const alsa_options device = session::device_options(s, s.stream, e, channels, rate);
    const std::string server = session::prepare_server(device.pcm);
    session::play_session session(device, s.stream, e);
    if (!o.json())
        say(stdout, "{}\n", describe(session.setup()));
    flush_output();
    const std::string late = session::latency_warning(s.stream.latency_ms, session.setup());
    if (!late.empty())
        say(stderr, "tactor: warning: {}\n", late);
    session::warn_of_server(server);
    play_report r;
    const auto broken = play(session, r.strokes);
    static_cast<session::run_facts&>(r) = session.finish();
    if (o.json())
        print_json(r);
    else if (s.stream.verbose || !is_undisturbed(r))
        print_table(r);
    return find_run_status(r, session.signal(), broken);
}

// Plays a live stroke that follows lines of points, until the lines end.
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
        return session::look{.descriptor = lines.descriptor()};
    });
}

// Refuses options that do not apply to live strokes, and output to the file that is standard input.
void check_live_options(const settings& s)
{
    if (s.strokes.size() != 1 || s.strokes.front() != "-" || s.path_data)
        refuse_option("--live", "it reads points from standard input, so STROKE must be -",
                      "use tactor play --live -");
    for (const options::option& o : options::all())
        if ((o.where & (options::planning | options::by_client)) != 0 && (o.where & options::live) == 0 &&
            s.gives(o))
            refuse_option(option_name(o),
                          "it does not apply to live strokes, whose points have their own times",
                          "leave out " + option_name(o));
    if (s.stream.arm)
        refuse_option("--arm", "a live stroke cannot be armed: it starts with its first point",
                      "leave out --arm");
    detail::note_input("/dev/fd/0");
}

// Plays live strokes until standard input ends.
int play_live(settings& s, const play_options& o)
{
    s.strokes.clear(); // standard input contains points, not a stroke file
    const environment e = session::read_environment(s);
    const live_options usual;
    live_options l;
    l.plan = s.plan;
    if (!s.gives("algorithm"))
        l.plan.algorithm = usual.plan.algorithm;
    if (!s.gives("outside"))
        l.plan.outside = usual.plan.outside;
    l.render = session::find_render_options(s, e);
    l.timeout_s = live_timeout_s;
    l.smooth_s = s.stream.smooth_s.value_or(l.smooth_s);
    return play_and_report(
        s, e, l.render.channels, l.render.rate, o,
        [&](session::play_session& session, std::vector<stroke_outcome>& outcomes) -> std::optional<error> {
            live_lines lines(s.intensity_max.value_or(1.0));
            outcomes.push_back({"live"});
            stroke_outcome& out = outcomes.back();
            out.report = follow_lines(session, l, lines);
            out.length_frames = out.report->frames;
            session.log_end(out.name, *out.report);
            print_outcome(out, session.setup().rate, o.json());
            return {};
        });
}

int play(settings& s, const play_options& o)
{
    if (s.stream.live)
        check_live_options(s);
    else if (s.stream.smooth_s)
        refuse_option("--smooth", "only live points can be smoothed", "add --live, or leave out --smooth");
    check_rounds(s, o);
    if (o.socket)
        return play_remote(s, o);
    if (s.stream.live)
        return play_live(s, o);
    const environment e = session::read_environment(s);
    const layout faces(e.tactors);
    std::vector<piece> pieces;
    for (const std::string& argument : stroke_arguments(s))
        pieces.push_back(open_piece(s, e, faces, argument));
    const auto scores = make_scores(pieces, s, e, faces, session::find_render_options(s, e));
    return play_and_report(s, e, scores.front().channels(), scores.front().rate(), o,
                           [&](session::play_session& session, std::vector<stroke_outcome>& outcomes) {
                               return play_all(session, o, e.tactors, pieces, scores, outcomes);
                           });
}

} // namespace

// Reads the available bytes. Returns false if no bytes are available.
bool live_lines::fill()
{
    pollfd p{STDIN_FILENO, POLLIN, 0};
    if (end_ || ::poll(&p, 1, 0) <= 0)
        return false;
    char bytes[4096];
    const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return false;
    if (n < 0)
        session::refuse_standard_input(errno);
    if (n == 0) {
        end_ = true;
        if (!buffer_.empty() && buffer_.back() != '\n')
            buffer_ += '\n'; // the last line may lack a line end
        return !buffer_.empty();
    }
    buffer_.append(bytes, static_cast<std::size_t>(n));
    return true;
}

std::optional<timed_point> live_lines::next()
{
    do {
        for (std::size_t end = buffer_.find('\n'); end != std::string::npos; end = buffer_.find('\n')) {
            const std::string line = buffer_.substr(0, end);
            buffer_.erase(0, end + 1);
            ++line_;
            if (const auto point = parse(line_ == 1 ? detail::strip_byte_order_mark(line) : line))
                return point;
        }
        if (buffer_.size() > longest_line)
            throw error(error_kind::bad_input, line_place(line_ + 1),
                        fmt::format("the line has more than {} bytes", longest_line), point_hint);
    } while (fill());
    return std::nullopt;
}

std::optional<timed_point> live_lines::parse(std::string_view line)
{
    const auto words = split(line);
    if (words.empty() || words.front().front() == '#')
        return std::nullopt;
    const auto refuse = [&](const std::string& why) {
        throw error(error_kind::bad_input, line_place(line_), why, point_hint);
    };
    double v[3] = {};
    bool lost = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i].find(',') != std::string_view::npos)
            refuse(fmt::format("commas are not allowed, as in \"{}\"", words[i]));
        if (i == std::size(v))
            refuse(fmt::format("the line has {}, not 2 or 3", counted(words.size(), "value")));
        const auto number = read_number(words[i]);
        if (!number || std::isinf(*number))
            refuse(fmt::format("\"{}\" is not a number", words[i]));
        v[i] = *number;
        lost = lost || std::isnan(v[i]);
        if (std::abs(v[i]) > farthest_mm || (i == 2 && v[i] < 0.0))
            refuse(fmt::format("{} {} is out of range",
                               i == 0   ? "x"
                               : i == 1 ? "y"
                                        : "the intensity",
                               words[i]));
    }
    if (lost && last_)
        return timed_point{.position = *last_, .intensity = 0.0};
    if (lost)
        return std::nullopt;
    if (words.size() < 2)
        refuse(fmt::format("the line has {}, not 2 or 3", counted(words.size(), "value")));
    last_ = point{v[0], v[1]};
    return timed_point{.position = *last_, .intensity = words.size() == 3 ? v[2] / intensity_max_ : 1.0};
}

int live_lines::descriptor() const noexcept
{
    return over() ? -1 : STDIN_FILENO;
}

void live_lines::warn(const std::string& remark) const
{
    say(stderr,
        "tactor: warning: standard input:{}: {} (the order is x y [intensity]; further points of this kind "
        "are only counted)\n",
        line_, remark);
}

int run_play(command_line& line)
{
    play_options o;
    add_stroke_argument(line, max_strokes);
    settings& s = add_options(line, options::on_play);
    line.app.add_option("--socket", o.socket, "play through the server at this socket")->type_name("PATH");
    add_text_option(line.app, "--repeat", "N|forever", "play N times, or until Ctrl-C (default 1)",
                    [&o](const std::string& text) { o.rounds = parse_rounds(text); });
    add_text_option(line.app, "--pause", "S", "silence between rounds, exact to the frame (default 0)",
                    [&o](const std::string& text) {
                        o.pause_s = options::parse_number("--pause", text, {0.0, 86400.0}, "s");
                    });
    add_format_option(line.app, o.format, {"text", "json"}, "format of the report (default text)");
    line.app.footer("tactor play park2016-3 -D hw:CARD=Tactor --level-dbfs -40\n"
                    "tactor play --shape circle --duration 2 --level-dbfs -20 -D null\n"
                    "tactor play park2016-1 park2016-3 --log play.log -D null");
    line.parse();
    return play(s, o);
}

} // namespace tactor::cli
