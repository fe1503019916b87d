// SPDX-License-Identifier: MIT
// tactor status and tactor stop: what a server does, and an end to it.
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/say.hpp"
#include "cli/serve/rpc_client.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "session/interrupt.hpp"

namespace tactor::cli {
namespace {

struct status_options {
    std::optional<std::string> socket;
    bool watch = false;
    std::string format = "text";

    bool json_lines() const { return format == "json"; }
};

void add_socket(CLI::App& c, std::optional<std::string>& into)
{
    c.add_option("--socket", into, "socket of the server (default: the user's, else the system's)")
        ->type_name("PATH");
}

void print_status(const net::json& s)
{
    const net::json& stream = s["stream"];
    const std::string reason = stream.value("reason", "");
    say(stdout, "stream     {}{}\n", stream.value("state", ""), reason.empty() ? "" : ": " + reason);
    say(stdout, "xruns      {}\n", stream.value("xruns", 0));
    say(stdout, "uptime     {}\n", seconds_text(stream.value("uptime_s", 0.0)));
    say(stdout, "real time  {}\n", stream.value("realtime", false) ? "yes" : "no");
    say(stdout, "amplifier  {}\n", s.value("amplifier", ""));
    say(stdout, "clients    {}\n", s.value("clients", 0));
    for (const net::json& c : s.value("who", net::json::array())) {
        const std::string name = c.value("name", "");
        const std::string from = c.value("from", "");
        say(stdout, "  {}{}{}\n", c.value("client", 0), name.empty() ? "" : " " + shown(name),
            from.empty() ? "" : " from " + shown(from));
    }
    say(stdout, "strokes    {}\n", s["strokes"].size());
    for (const net::json& k : s["strokes"])
        say(stdout, "  {} {}, client {}\n", k.value("stroke", 0), k.value("state", ""), k.value("client", 0));
}

void print_event(const net::json& n)
{
    const net::json& p = n["params"];
    const std::string reason = p.value("reason", "");
    const std::string who =
        n["method"] == "stroke" ? fmt::format("stroke {}", p.value("stroke", 0)) : n.value("method", "");
    say(stdout, "{}: {}{}\n", who, p.value("state", ""), reason.empty() ? "" : ": " + reason);
}

void print_json_line(const net::json& j)
{
    fmt::print("{}\n", j.dump(-1, ' ', false, net::json::error_handler_t::replace));
}

// Prints notifications until the server ends. Throws interrupted.
void watch(rpc_client& server, const status_options& o)
{
    for (;;) {
        while (const auto n = server.notification()) {
            if (o.json_lines())
                print_json_line(*n);
            else
                print_event(*n);
            flush_output();
            if (std::ferror(stdout) != 0)
                return; // main() reports it
            if ((*n)["method"] == "stream" && (*n)["params"].value("state", "") == "closing")
                return;
        }
        server.wait();
    }
}

void status(const status_options& o, session::interrupt& stop)
{
    rpc_client server(o.socket, stop);
    if (o.watch)
        server.call("subscribe", {{"events", {"strokes", "stream"}}});
    const net::json s = server.call("status");
    if (o.json_lines())
        print_json_line(s);
    else
        print_status(s);
    flush_output();
    if (o.watch)
        watch(server, o);
}

// Calls `ask`, which a signal interrupts, also while the server does not answer.
template <typename F>
int until_interrupted(F ask)
{
    session::interrupt stop;
    try {
        ask(stop);
        return status_ok;
    } catch (const interrupted& i) {
        return session::interrupt::status(i.signal);
    }
}

} // namespace

int run_status(command_line& line)
{
    status_options o;
    add_socket(line.app, o.socket);
    line.app.add_flag("--watch", o.watch, "print each change on a line until Ctrl-C");
    add_format_option(line.app, o.format, {"text", "json"}, "format of the output (default text)");
    line.app.footer("tactor status\n"
                    "tactor status --watch\n"
                    "tactor status --format json");
    line.parse();
    return until_interrupted([&](session::interrupt& stop) { status(o, stop); });
}

int run_stop(command_line& line)
{
    std::optional<std::string> socket;
    add_socket(line.app, socket);
    line.app.footer("tactor stop\n"
                    "tactor stop --socket /run/tactor/tactor.sock");
    line.parse();
    return until_interrupted([&](session::interrupt& stop) { rpc_client(socket, stop).call("stop"); });
}

} // namespace tactor::cli
