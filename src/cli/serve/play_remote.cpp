// SPDX-License-Identifier: MIT
#include "cli/play/play.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <thread>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <unistd.h>

#include <tactor/stroke.hpp>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/serve/rpc_client.hpp"
#include "cli/settings.hpp"
#include "files/plan/plan_json.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"
#include "session/live_remarks.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

constexpr std::chrono::seconds to_finish{10};       // time for a server to fade out after a signal
constexpr std::chrono::milliseconds limit_pause{5}; // about ten points at 2,000 points per second

// Refuses options that only the server's owner may set, or that servers do not have.
void refuse_owner_options(const settings& s)
{
    for (const options::option& o : options::all())
        if ((o.where & (options::by_client | options::through_server)) == 0 && s.gives(o))
            refuse_option(option_name(o),
                          "it has no effect with --socket, because a server plays the strokes",
                          "leave out " + option_name(o));
}

// If an error of the server is about a parameter that contains a stroke, adds the name of the stroke and the
// place in it.
error locate_stroke_error(const error& e, const std::string& param, const std::string& argument)
{
    const std::vector<std::string_view>& sources = session::source_names();
    if (std::find(sources.begin(), sources.end(), param) == sources.end())
        return e;
    const source_place at{argument, e.place().line, e.place().column};
    return e.reworded(at.text(), e.why(), e.hint()).with_place(at);
}

// Replaces the format's name, with which the server's warnings begin, by the name of the STROKE.
std::vector<std::string> name_in(std::vector<std::string> warnings, const std::string& stroke)
{
    for (std::string& w : warnings)
        for (const detail::stroke_format* f : detail::stroke_formats())
            if (w.starts_with(fmt::format("{}:", f->name)))
                w.replace(0, f->name.size(), shown_name(stroke));
    return warnings;
}

// Returns a STROKE argument as a parameter of the method `play`: a preset, or the text of a file.
net::json make_params(const std::string& argument)
{
    constexpr std::size_t most_bytes = 48U << 20;
    if (is_wav_argument(argument))
        throw error(error_kind::bad_input, argument, "it has samples, which a server does not accept",
                    "play the file without --socket, when the device is free");
    if (const auto preset = find_preset(argument))
        return {{"stroke", preset->name}};
    const bool piped = argument == "-";
    if (piped)
        detail::note_input("/dev/fd/0");
    else
        session::check_readable(argument);
    const detail::whole_text text = piped ? detail::read_text(STDIN_FILENO, shown_name(argument), most_bytes)
                                          : detail::read_text_file(argument, most_bytes);
    if (files::holds_plans(text))
        throw error(error_kind::bad_input, shown_name(argument),
                    "it is a plan, which a server does not accept", "give the stroke");
    const detail::stroke_format* format = detail::find_stroke_format(text, piped ? "" : argument);
    return {{std::string(format->name), std::string_view(text)}};
}

// Returns the name of each STROKE together with its parameter.
std::vector<std::pair<std::string, net::json>> stroke_params(const settings& s)
{
    const std::vector<std::string> arguments = stroke_arguments(s);
    if (s.path_data)
        return {{arguments.front(), {{"path", *s.path_data}}}};
    if (s.shape)
        return {{arguments.front(), {{"stroke", *s.shape}}}};
    std::vector<std::pair<std::string, net::json>> all;
    for (const std::string& argument : arguments)
        all.emplace_back(argument, make_params(argument));
    return all;
}

// Returns the options on the command line as a parameter. Other options keep the values of the server's
// owner.
net::json client_options(const settings& s)
{
    net::json given = net::json::object();
    for (const options::option& o : options::all()) {
        if ((o.where & options::by_client) == 0 || !s.gives(o))
            continue;
        std::visit(
            [&]<class T>(const T& v) {
                if constexpr (!std::is_same_v<T, std::monostate>)
                    given[std::string(o.name)] = v;
            },
            o.to.get(s));
    }
    return given;
}

// Reads the weakening of a piece from the server's answer.
weakening read_weakening(const net::json& answer)
{
    weakening w{.weakened_db = answer.value("weakened_db", 0.0)};
    if (const auto at = answer.find("meets"); at != answer.end()) {
        w.tactor = at->value("tactor", 0U);
        w.at_s = at->value("at_s", 0.0);
        w.plans = at->value("strokes", std::vector<std::size_t>{});
    }
    return w;
}

class remote_player {
public:
    remote_player(const settings& s, const play_options& o)
        : options_(o), stream_(s.stream), server_(o.socket, stop_), asked_(client_options(s))
    {
        const net::json hello = server_.call("hello");
        const net::json& d = hello["stream"];
        report_.device.name = d.value("pcm", "");
        report_.device.rate = d.value("rate", 48000U);
        report_.device.channels = d.value("channels", 0U);
        if (d["format"].is_string())
            report_.device.format = from_string<format_kind>(d["format"].get<std::string>());
        report_.device.period_frames = d.value("period_frames", 0U);
        report_.device.buffer_frames =
            static_cast<unsigned>(std::lround(d.value("latency_s", 0.0) * report_.device.rate));
        xruns_ = server_.call("status")["stream"].value("xruns", std::uint64_t{0});
    }

    int play(const std::vector<std::pair<std::string, net::json>>& pieces)
    {
        if (!options_.json())
            say(stdout, "{} through {}\n", describe(report_.device), server_.socket());
        flush_output();
        for (const auto& [name, params] : pieces)
            report_.strokes.push_back({name});
        const auto goes_on = [this] { return server_.signal() == 0 && !broken_; };
        for (std::size_t i = 0; i < pieces.size() && goes_on(); ++i)
            play_remote_stroke(report_.strokes[i], pieces[i].second, i + 1 == pieces.size());
        if (stream_.arm) // each round waits for its own edge of the trigger
            for (std::uint64_t k = 1; k != options_.rounds && goes_on(); ++k)
                play_remote_stroke(report_.strokes.front(), pieces.front().second, true);
        return finish();
    }

    int play_live(live_lines& lines)
    {
        report_.strokes.push_back({"live"});
        stroke_outcome& out = report_.strokes.back();
        asked_.erase("intensity_max"); // this program scales the intensities itself
        net::json begin{{"options", asked_}, {"timeout_s", live_timeout_s}};
        if (stream_.smooth_s)
            begin["smooth_s"] = *stream_.smooth_s;
        server_.set_grace_period(to_finish);
        const net::json n = server_.call("begin", begin)["stroke"];
        try {
            for (bool end_sent = false; !has_ended(n, out);) {
                wait(lines.descriptor());
                if (server_.signal() != 0 && !std::exchange(cancelled_, true))
                    server_.send_notification("cancel", {{"stroke", n}});
                if (!cancelled_)
                    draw(n, lines);
                if (lines.over() && !std::exchange(end_sent, true) && !cancelled_)
                    server_.send_notification("end", {{"stroke", n}});
            }
        } catch (const error&) {
            try {
                server_.send_notification("cancel",
                                          {{"stroke", n}}); // otherwise the burst would play to its end
            } catch (
                const error&) { // NOLINT(bugprone-empty-catch): the server is gone, as the other error says
            }
            throw;
        }
        print_outcome(out, report_.device.rate, options_.json());
        check_outcome(out, true);
        return finish();
    }

private:
    // Sends points until there are no more points, a signal arrives, or the stroke ends.
    void draw(const net::json& n, live_lines& lines)
    {
        while (server_.signal() == 0) {
            const auto p = lines.next();
            if (!p || !move(n, *p, lines))
                return;
        }
    }

    // Sends a point. If the server accepts no more points, waits, so that no point is lost. Returns false if
    // the stroke has ended.
    bool move(const net::json& n, const timed_point& p, const live_lines& lines)
    {
        const net::json to{
            {"stroke", n}, {"x_mm", p.position.x_mm}, {"y_mm", p.position.y_mm}, {"intensity", p.intensity}};
        try {
            while (!server_.try_call("to", to)) {
                if (server_.signal() != 0)
                    return false;
                std::this_thread::sleep_for(limit_pause);
            }
            if (p.intensity > 1.0 && !std::exchange(is_loud_, true))
                lines.warn(session::intensity_limit_text(p.intensity * lines.intensity_max(),
                                                         lines.intensity_max()));
            return true;
        } catch (const server_error& e) {
            if (e.rpc_code != net::code_no_stroke)
                throw;
            return false;
        }
    }

    void play_remote_stroke(stroke_outcome& out, net::json params, bool last)
    {
        params["options"] = asked_;
        if (stream_.arm)
            params["start"] = "armed";
        const bool server_repeats = options_.rounds != 1 && !stream_.arm;
        if (server_repeats) {
            params["repeat"] = options_.rounds == 0 ? net::json(true) : net::json(options_.rounds);
            params["pause_s"] = options_.pause_s;
        } else {
            out.rounds = out.rounds.value_or(0) + 1;
        }
        net::json r;
        server_.set_grace_period(to_finish);
        try {
            r = server_.call("play", params);
        } catch (const server_error& e) {
            throw locate_stroke_error(e, e.param, shown_name(out.name));
        }
        print_grouped_warnings(name_in(r["warnings"].get<std::vector<std::string>>(), out.name));
        out.weakened = read_weakening(r);
        warn_of_weakening(shown_name(out.name), out.weakened, r["strokes"].size());
        out.length_frames =
            static_cast<std::uint64_t>(std::llround(r.value("total_s", 0.0) * report_.device.rate));
        if (stream_.arm && !options_.json())
            say(stdout, "{}: armed\n", shown_name(out.name));
        flush_output();
        for (const net::json& n : r["strokes"])
            while (!has_ended(n, out)) {
                wait(-1);
                if (server_.signal() != 0 && !std::exchange(cancelled_, true))
                    for (const net::json& k : r["strokes"])
                        cancel(k);
            }
        print_outcome(out, report_.device.rate, options_.json());
        check_outcome(out, last);
    }

    // Cancels a stroke. Ignores the error if the stroke has already ended.
    void cancel(const net::json& n)
    {
        try {
            server_.call("cancel", {{"stroke", n}});
        } catch (const error& e) {
            if (e.kind() != error_kind::runtime)
                throw;
        }
    }

    // Returns true if the stroke has ended. For a piece of several strokes, the report contains the
    // first end that is not `finished`.
    bool has_ended(const net::json& n, stroke_outcome& out)
    {
        while (const auto m = server_.notification())
            if ((*m)["method"] == "stroke" && (*m)["params"].value("state", "") != "started")
                ends_.push_back((*m)["params"]);
        const auto found =
            std::find_if(ends_.begin(), ends_.end(), [&](const net::json& e) { return e["stroke"] == n; });
        if (found == ends_.end())
            return false;
        stroke_report r{.state = from_string<state_kind>(found->value("state", "interrupted")),
                        .frames = found->value("frames", std::uint64_t{0}),
                        .why = found->value("reason", ""),
                        .late_s = found->value("late_s", 0.0),
                        .held_points = found->value("held_points", std::uint64_t{0}),
                        .outside_points = found->value("outside_points", std::uint64_t{0}),
                        .doubt = found->value("doubt", "")};
        if ((*found)["started_s"].is_number())
            r.started_ns = std::llround((*found)["started_s"].get<double>() * 1e9);
        ends_.erase(found);
        add_report(out.report, std::move(r));
        return true;
    }

    // Waits for input. After a signal, does not wait before the strokes have been cancelled.
    void wait(int also)
    {
        if (server_.signal() == 0 || cancelled_)
            server_.wait(also);
    }

    void check_outcome(const stroke_outcome& out, bool last)
    {
        if (server_.signal() != 0 || out.report->state == state_kind::finished)
            return;
        const bool cancelled = out.report->state == state_kind::cancelled;
        const bool gone = server_.call("status")["stream"].value("state", "") == "lost";
        const std::string why = outcome_text(out, report_.device.rate);
        if (cancelled || gone || stream_.void_on_xrun)
            broken_.emplace(error_kind::runtime, shown_name(out.name), why,
                            stream_.void_on_xrun && !cancelled ? "repeat the run: --void-on-xrun made it void"
                                                               : "");
        else if (!last)
            say(stderr, "tactor: warning: {}\n", describe(out, report_.device.rate));
    }

    int finish()
    {
        try {
            const net::json s = server_.call("status")["stream"];
            report_.stats.xruns = s.value("xruns", std::uint64_t{0}) - xruns_;
            report_.stats.realtime = s.value("realtime", false);
        } catch (const error& e) {
            if (server_.signal() == 0 && !broken_)
                broken_.emplace(e);
        }
        if (options_.json())
            print_json(report_);
        else if (report_.stats.xruns != 0)
            say(stdout, "xruns           {}\n", report_.stats.xruns);
        return find_run_status(report_, server_.signal(), broken_);
    }

    const play_options& options_;
    const session::stream_options& stream_;
    session::interrupt stop_;
    rpc_client server_;
    net::json asked_;
    play_report report_;
    std::vector<net::json> ends_;
    std::optional<error> broken_;
    std::uint64_t xruns_ = 0;
    bool cancelled_ = false;
    bool is_loud_ = false; ///< true if a point was above intensity 1
};

} // namespace

int play_remote(const settings& s, const play_options& o)
{
    refuse_owner_options(s);
    const auto pieces = s.stream.live ? decltype(stroke_params(s)){} : stroke_params(s);
    try {
        remote_player player(s, o);
        live_lines lines(s.intensity_max.value_or(1.0));
        return s.stream.live ? player.play_live(lines) : player.play(pieces);
    } catch (const interrupted& i) {
        return session::interrupt::status(i.signal);
    }
}

} // namespace tactor::cli
