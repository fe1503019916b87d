// SPDX-License-Identifier: MIT
// The command `serve`, which lets other programs play strokes.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <grp.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>

#include <tactor/version.hpp>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/plan/plan_members.hpp"
#include "net/rpc.hpp"
#include "options/option.hpp"
#include "rt/clock.hpp"
#include "rt/system_files.hpp"
#include "rt/thread.hpp"
#include "server/server.hpp"
#include "session/device.hpp"
#include "session/log.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

using files::or_null;

// Returns true if this process is a system service. The service manager then gives it a runtime folder that
// is not in the user's folder.
bool is_system_service()
{
    const std::string given = rt::service_folder();
    const std::string users = rt::variable("XDG_RUNTIME_DIR");
    return !given.empty() && (users.empty() || !given.starts_with(users + "/"));
}

// Returns the default path of the Unix socket. Returns "" if there is no folder for it but other endpoints
// exist.
std::string default_socket(bool others)
{
    if (const std::string folder = rt::runtime_folder(); !folder.empty())
        return folder + "/tactor.sock";
    if (others)
        return {};
    throw error(error_kind::bad_input, "socket",
                "neither RUNTIME_DIRECTORY nor XDG_RUNTIME_DIR names a folder for it",
                "name a socket with --socket PATH, or under [serve] in the configuration");
}

// Returns the settings `s` from the configuration, with some values replaced by the options `o`.
options::serve_settings resolve_serve_settings(const options::serve_settings& o, options::serve_settings s)
{
    const auto prefer = [](auto& ours, const auto& given) {
        if (given)
            ours = given;
    };
    prefer(s.socket, o.socket);
    prefer(s.tcp, o.tcp);
    prefer(s.osc, o.osc);
    prefer(s.http, o.http);
    prefer(s.bhaptics, o.bhaptics);
    prefer(s.idle_stop_s, o.idle_stop_s);
    return s;
}

// Returns the ceiling from --max-level-dbfs, or from the files if this option is not set. Refuses an option
// that exceeds a ceiling in the files.
session::ceiling resolve_ceiling(const environment& e, std::optional<double> asked_dbfs)
{
    session::ceiling said = session::find_ceiling(e);
    if (!asked_dbfs)
        return said;
    const bool is_said = e.serve.max_level_dbfs || said.from.starts_with("level-dbfs");
    if (is_said && *asked_dbfs > said.dbfs)
        refuse_option(
            "--max-level-dbfs",
            fmt::format("{} dBFS is above the limit of {} dBFS from {}", plain_number(*asked_dbfs, 4),
                        plain_number(said.dbfs, 4), said.from),
            fmt::format("use {} dBFS or less, or change the limit in the file", plain_number(said.dbfs, 4)));
    return {*asked_dbfs, "--max-level-dbfs"};
}

// Refuses options that would weaken a limit in the files.
void check_limits(const session::stream_options& asked, const environment& e)
{
    const limit_settings said = e.config.limits.value_or(limit_settings{});
    const auto refuse = [](const char* option, double value, double limit, const char* unit) {
        const bool is_above = value > limit;
        const std::string bound = fmt::format("{} {}", plain_number(limit, 4), unit);
        refuse_option(
            option,
            fmt::format("{} {} is {} the limit of {} under [limits]", plain_number(value, 4), unit,
                        is_above ? "above" : "below", bound),
            fmt::format("use {} or {}, or change the limit in the file", bound, is_above ? "less" : "more"));
    };
    if (said.power_dbfs && asked.power_dbfs.value_or(*said.power_dbfs) > *said.power_dbfs)
        refuse("--power-dbfs", *asked.power_dbfs, *said.power_dbfs, "dB");
    if (said.max_drive_s && asked.max_drive_s.value_or(*said.max_drive_s) > *said.max_drive_s)
        refuse("--max-drive-s", *asked.max_drive_s, *said.max_drive_s, "s");
    if (said.window_s && asked.drive_window_s.value_or(*said.window_s) < *said.window_s)
        refuse("--drive-window-s", *asked.drive_window_s, *said.window_s, "s");
}

server::endpoint_options resolve_endpoints(const options::serve_settings& s)
{
    if (s.socket && s.socket->empty())
        refuse_option("--socket", "the path is empty", "give the path of a socket");
    server::endpoint_options e;
    e.allow_hosts = s.allow_hosts;
    e.osc_peers = s.osc_peers;
    e.socket = [given = s.socket, others = s.tcp || s.osc || s.http || s.bhaptics] {
        return given ? *given : default_socket(others);
    };
    if (is_system_service()) {
        e.mode = S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;
        if (const group* g = ::getgrnam("tactor"))
            e.group = g->gr_gid;
        else
            say(stderr, "tactor: warning: there is no group tactor: only this user's group may draw\n");
    }
    if (s.tcp)
        e.tcp = net::parse_host(*s.tcp, "--tcp");
    if (s.http)
        e.http = net::parse_host(*s.http, "--http");
    if (s.osc)
        e.osc = net::parse_host(*s.osc, "--osc");
    if (s.bhaptics)
        e.bhaptics = net::parse_host(*s.bhaptics, "--bhaptics");
    return e;
}

// Raises the limit on open files to the number that the clients need. Prints a warning if this is not
// allowed.
void raise_descriptor_limit(const server::service_limits& l)
{
    // OSC senders share a single descriptor. Browsers that only load the page do not count as clients.
    constexpr rlim_t others = 96;
    const rlim_t wanted = l.max_clients + others;
    rlimit now{};
    if (::getrlimit(RLIMIT_NOFILE, &now) != 0 || now.rlim_cur >= wanted)
        return;
    now.rlim_cur = std::min(wanted, now.rlim_max);
    if (::setrlimit(RLIMIT_NOFILE, &now) != 0 || now.rlim_cur < wanted)
        say(stderr,
            "tactor: warning: too few descriptors: {} may be open, but {} clients need {}, so the server "
            "will refuse some clients (raise ulimit -n, or LimitNOFILE= of the unit)\n",
            now.rlim_cur, l.max_clients, wanted);
}

// Returns the output of `tactor plan --format json` for answers of the service. Throws std::bad_alloc if it
// has more than `most_bytes`.
std::string plan_text(const server::planned& p, const environment& e, std::size_t most_bytes)
{
    const score samples(e.tactors, p.plans, p.render);
    std::string text;
    files::write_plans({p, e.tactors, samples, p.render}, [&](std::string_view part) {
        if (text.size() + part.size() > most_bytes)
            throw std::bad_alloc();
        text += part;
    });
    return text;
}

// Limits the level of each channel, for all clients together, to the ceiling. If a gain makes a tactor
// stronger, its limit is raised by this gain. A tactor with a threshold is an exception: gains do not apply
// to sensation levels, so that a higher limit would allow sums above the ceiling.
array limit_levels(array a, double max_level_dbfs)
{
    for (tactor_spec& t : a.tactors) {
        const bool measured = t.threshold_dbfs || !t.thresholds.empty();
        const double gain_db = measured ? 0.0 : std::max(t.gain_db, 0.0);
        t.max_dbfs = std::min(t.max_dbfs, max_level_dbfs + gain_db);
    }
    return a;
}

server::planning make_planning(const settings& s, const environment& e, double ceiling_dbfs,
                               const server::service_limits& limits)
{
    server::planning p;
    p.owner = static_cast<const options::option_values&>(s);
    p.owner.intensity_max.reset(); // each client sets the value that means 1
    p.owner.render = session::find_render_options(s, e);
    p.max_level_dbfs = ceiling_dbfs;
    p.owner.render.level_dbfs = std::min(p.owner.render.level_dbfs, p.max_level_dbfs);
    p.tactors = limit_levels(e.tactors, p.max_level_dbfs);
    p.max_stroke_s = limits.max_stroke_s;
    p.max_strokes = limits.max_strokes;
    return p;
}

void warn_of_access(const server::endpoints& at, const std::string& token)
{
    const bool has_peers = !at.osc_peers.empty();
    for (const auto& [kind, address, fd] :
         {std::tuple("osc", &at.osc_address, &at.osc), {"bhaptics", &at.bhaptics_address, &at.bhaptics}}) {
        if (address->empty())
            continue;
        if (!has_peers && !net::is_loopback(fd->get()))
            throw error(error_kind::bad_input, fmt::format("{} {}", kind, *address),
                        "other machines can reach it, and osc_peers lists none",
                        "set osc_peers under [serve] in the configuration, or listen on 127.0.0.1");
        say(stderr, "tactor: warning: {} {}: every user of this machine can draw through it{}\n", kind,
            *address, has_peers ? ", and anybody who sends with an address in osc_peers" : "");
    }
    constexpr std::size_t least_token = 16;
    for (const auto& [kind, address, fd] :
         {std::tuple("tcp", &at.tcp_address, &at.tcp), std::tuple("http", &at.http_address, &at.http)}) {
        if (address->empty())
            continue;
        const bool beyond = !net::is_loopback(fd->get());
        if (!token.empty() && beyond && token.size() < least_token)
            throw error(error_kind::bad_input, fmt::format("{} {}", kind, *address),
                        fmt::format("other machines can reach it, and the token has only {}",
                                    counted(token.size(), "character")),
                        fmt::format("put at least {} characters into token_file", least_token));
        if (!token.empty())
            continue;
        if (beyond)
            throw error(error_kind::bad_input, fmt::format("{} {}", kind, *address),
                        "other machines can reach it, and no token is set",
                        "set token_file under [serve] in the configuration, or listen on 127.0.0.1");
        say(stderr,
            "tactor: warning: {} {}: every user of this machine can draw through it (set token_file under "
            "[serve] to require a token)\n",
            kind, *address);
    }
}

void print_endpoints(const server::endpoints& at, const session::ceiling& highest, const std::string& format)
{
    const std::string http = at.http_address.empty() ? "" : "http://" + at.http_address + "/";
    const std::string bhaptics =
        at.bhaptics_address.empty() ? "" : fmt::format("ws://{}/v2/feedbacks", at.bhaptics_address);
    if (format == "json") {
        nlohmann::ordered_json all{{"event", "listening"},           {"socket", or_null(at.socket_path)},
                                   {"tcp", or_null(at.tcp_address)}, {"osc", or_null(at.osc_address)},
                                   {"http", or_null(http)},          {"max_level_dbfs", highest.dbfs}};
        if (!bhaptics.empty())
            all["bhaptics"] = bhaptics;
        fmt::print("{}\n", net::json_line(all));
    } else {
        for (const auto& [kind, address] : {std::pair("socket ", &at.socket_path),
                                            {"tcp ", &at.tcp_address},
                                            {"osc ", &at.osc_address},
                                            {"", &http},
                                            {"", &bhaptics}})
            if (!address->empty())
                say(stdout, "listening: {}{}\n", kind, *address);
        say(stdout, "ceiling: {}\n", session::ceiling_text(highest));
    }
    if (std::fflush(stdout) == 0)
        return;
    // Only a program that waits for these lines is affected, so continue to serve the clients.
    say(stderr, "tactor: warning: standard output: {}: the addresses could not be printed there\n",
        std::strerror(errno));
    std::clearerr(stdout);
}

// Returns a handler that reports changes of the stream's state on standard error and to the service manager.
std::function<void(server::stream_state, const std::string&)> make_owner_log()
{
    return [lost = false, ran = false](server::stream_state state, const std::string& reason) mutable {
        const bool again = std::exchange(ran, ran || state == server::stream_state::running);
        if (state == server::stream_state::lost)
            say(stderr, "tactor: warning: {}: {}\n", again ? "the stream is lost" : "waiting for the device",
                make_printable(reason));
        if (state == server::stream_state::running && lost)
            say(stderr, "tactor: the stream runs{}\n", again ? " again" : "");
        lost = state == server::stream_state::lost || (lost && state != server::stream_state::running);
        net::notify_manager(fmt::format("STATUS=stream: {}{}{}", to_string(state), reason.empty() ? "" : ": ",
                                        make_printable(reason)));
    };
}

int serve(settings& s, const options::serve_settings& o, const std::string& format)
{
    // [defaults] apply to strokes and predictions of clients that do not set these options.
    s.place |= options::on_play | options::on_compare;
    const environment e = session::read_environment(s);
    const session::stream_options& play = s.stream;
    const options::serve_settings serve = resolve_serve_settings(o, e.serve);
    const session::ceiling highest = resolve_ceiling(e, o.max_level_dbfs);
    check_limits(play, e);
    const server::endpoint_options where = resolve_endpoints(serve);
    session::interrupt stop;

    server::service_options service;
    service.limits = serve.limits;
    raise_descriptor_limit(service.limits);
    service.token = server::read_token(serve);
    service.version = version();
    service.array = files::make_document(e.tactors);
    service.array.update(files::describe_site(e.tactors));
    service.plans = make_planning(s, e, highest.dbfs, service.limits);
    service.plan_text = [&e](const server::planned& p, std::size_t most) { return plan_text(p, e, most); };
    service.now_ns = rt::monotonic_ns;
    server::endpoints at = server::open_endpoints(where);
    const std::shared_ptr<void> removed(nullptr, [&at](void*) { server::remove_socket(at); });
    warn_of_access(at, service.token);

    // If the output goes to the journal, the log is always verbose, because nobody watches a service while it
    // runs.
    session::session_log log(play.verbose || session::goes_to_journal(stderr), play.log);
    const render_options& sound = service.plans.owner.render;
    alsa_options device = session::device_options(s, play, e, sound.channels, sound.rate);
    device.log = log.function();
    service.log = device.log;
    session::report_missing_device(s, e);
    session::warn_of_server(session::prepare_server(device.pcm));
    const bool armed = !play.no_gpio && e.config.sync && e.config.sync->in;
    server::stream_options stream{session::open_parts(device, play, e, armed)};
    const bool locked = session::prepare_realtime(play.require_realtime);
    session::enable_memory_return();
    const bool realtime = rt::thread({.name = "tactor-check", .fifo = true}, [] {}).fifo_error() == 0;
    session::warn_of_missing_rights(realtime, locked);
    stream.tactors = service.plans.tactors;
    stream.changed = [&stop, tell = make_owner_log()](server::stream_state state, const std::string& reason) {
        if (state == server::stream_state::closing)
            stop.poll(); // the time limit for the end starts here
        tell(state, reason);
    };
    stream.times.idle_stop_s = serve.idle_stop_s.value_or(0.0);
    server::serve(at, std::move(service), std::move(stream), stop.descriptor(),
                  [&] { print_endpoints(at, highest, format); });
    stop.ignore_further_signals();
    return status_ok;
}

} // namespace

int run_serve(command_line& line)
{
    options::serve_settings o; // options of [serve] that are also on the command line
    std::string format;
    CLI::App& c = line.app;
    c.add_option("--socket", o.socket,
                 "Unix socket (default: tactor.sock in RUNTIME_DIRECTORY, else in XDG_RUNTIME_DIR)")
        ->type_name("PATH");
    c.add_option("--tcp", o.tcp, "also listen on this TCP port; 0 selects a free one")
        ->type_name("[HOST:]PORT");
    c.add_option("--osc", o.osc, "receive OSC on this UDP port; 0 selects a free one")
        ->type_name("[HOST:]PORT");
    c.add_option("--http", o.http, "serve a page to draw on, and WebSockets, on this port")
        ->type_name("[HOST:]PORT");
    c.add_option("--bhaptics", o.bhaptics,
                 "play for programs made for the bHaptics player, which expect port 15881")
        ->type_name("[HOST:]PORT");
    add_text_option(
        c, "--idle-stop", "S", "stop the stream after this time without a stroke (default: never)",
        [&o](const std::string& t) {
            o.idle_stop_s = options::parse_number("--idle-stop", t, detail::bounds_of::timeout_s, "s");
        });
    add_text_option(c, "--max-level-dbfs", "DB",
                    "highest level of a client's strokes, and of their sum (default: the files', else -12)",
                    [&o](const std::string& t) {
                        o.max_level_dbfs = options::parse_number("--max-level-dbfs", t,
                                                                 detail::bounds_of::level_dbfs, "dBFS");
                    });
    settings& s = add_options(line, options::on_serve);
    add_format_option(c, format, {"text", "json"}, "format of the printed addresses (default text)");
    c.footer("tactor serve --http 4003 -D null\n"
             "tactor serve --http 4003 --max-level-dbfs -40 -D hw:CARD=Tactor\n"
             "tactor serve --osc 4002 --idle-stop 60 -D hw:CARD=Tactor");
    line.parse();
    return serve(s, o, format);
}

} // namespace tactor::cli
