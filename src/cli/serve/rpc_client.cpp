// SPDX-License-Identifier: MIT
// A client of the service, and the commands `status` and `stop`, which only call the service.
#include "cli/serve/rpc_client.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "rt/system_files.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

std::vector<std::string> list_socket_paths(const std::optional<std::string>& named)
{
    if (named)
        return {*named};
    std::vector<std::string> all;
    if (const std::string folder = rt::variable("XDG_RUNTIME_DIR"); !folder.empty())
        all.push_back(folder + "/tactor.sock");
    all.emplace_back("/run/tactor.sock");
    all.emplace_back("/run/tactor/tactor.sock");
    return all;
}

// Connects to a socket. Returns 0 on success, otherwise an errno.
int try_to_connect(const std::string& path, net::owned_fd& into)
{
    sockaddr_un a{};
    a.sun_family = AF_UNIX;
    if (path.size() >= sizeof a.sun_path)
        return ENAMETOOLONG;
    std::memcpy(static_cast<char*>(a.sun_path), path.c_str(), path.size() + 1);
    net::owned_fd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the socket API requires it
    if (!fd || ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&a), sizeof a) != 0)
        return errno;
    into = std::move(fd);
    return 0;
}

// Returns true for network addresses: "127.0.0.1:4001", "4001" and "http://pi:4003/".
bool is_address(const std::string& text)
{
    const std::string port = text.substr(text.rfind(':') + 1);
    return text.find("://") != std::string::npos ||
           (!port.empty() && port.find_first_not_of("0123456789") == std::string::npos);
}

// Converts the protocol's names of options to marks: "options.soa" to "{soa}".
std::string convert_option_names(const std::string& text)
{
    static const std::regex option("options\\.([a-z_]+)");
    return std::regex_replace(text, option, "{$1}");
}

server_error make_error(const net::json& e)
{
    const int code = e.value("code", 0);
    const error_kind kind = code == net::code_bad_params  ? error_kind::bad_input
                            : code == net::code_no_stream ? error_kind::not_available
                                                          : error_kind::runtime;
    const net::json data = e.value("data", net::json::object());
    if (!data.is_object() || !data.contains("why"))
        return {error(kind, "server", e.value("message", "it refuses")), code, {}};
    const std::string what = data.value("what", "server");
    return {error(kind, convert_option_names(what), convert_option_names(data.value("why", "")),
                  convert_option_names(data.value("hint", "")))
                .with_place({"", data.value("line", 0U), data.value("column", 0U)}),
            code, what};
}

} // namespace

rpc_client::rpc_client(const std::optional<std::string>& socket, session::interrupt& stop) : stop_(stop)
{
    if (socket && socket->empty())
        refuse_option("--socket", "the path is empty", "give the path of a socket");
    const auto places = list_socket_paths(socket);
    int code = ENOENT;
    for (const std::string& p : places) {
        const int failed = try_to_connect(p, fd_);
        if (failed == 0) {
            path_ = p;
            return;
        }
        if (failed != ENOENT)
            code = failed;
    }
    if (socket && code == ENOENT && is_address(*socket))
        throw error(error_kind::not_available, "server at " + *socket, "it is not the path of a Unix socket",
                    "give --socket the path that tactor serve prints");
    struct stat s {};
    if (socket && ::stat(socket->c_str(), &s) == 0 && !S_ISSOCK(s.st_mode))
        throw error(error_kind::not_available, "server at " + *socket, "it is not a socket",
                    "give --socket the path that tactor serve prints");
    throw error(error_kind::not_available, fmt::format("server at {}", fmt::join(places, ", ")),
                code == ENOENT ? "no server listens there" : std::strerror(code),
                "start tactor serve, or name the socket of a server with --socket PATH");
}

void rpc_client::send(const net::json& message)
{
    const std::string text = net::json_line(message) + "\n";
    for (std::size_t sent = 0; sent < text.size();) {
        while (!poll(POLLOUT, -1)) {
        }
        const ssize_t n =
            ::send(fd_.get(), text.data() + sent, text.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n < 0 && (errno == EINTR || errno == EAGAIN))
            continue;
        if (n < 0)
            throw error(error_kind::runtime, "server", "the connection ended",
                        "see the messages of the server");
        sent += static_cast<std::size_t>(n);
    }
}

bool rpc_client::poll(short what, int also)
{
    using std::chrono::steady_clock;
    pollfd fds[] = {{stop_.descriptor(), POLLIN, 0}, {fd_.get(), what, 0}, {also, POLLIN, 0}};
    int most_ms = -1;
    if (signal_ != 0)
        most_ms = static_cast<int>(std::max<std::int64_t>(
            0, std::chrono::ceil<std::chrono::milliseconds>(deadline_ - steady_clock::now()).count()));
    const int ready = ::poll(fds, 3, most_ms);
    if (const int s = stop_.poll()) {
        if (std::exchange(signal_, s) != 0 || grace_.count() == 0)
            throw interrupted{s};
        deadline_ = steady_clock::now() + grace_;
    } else if (ready == 0) {
        throw interrupted{signal_};
    }
    return fds[1].revents != 0;
}

void rpc_client::wait(int also)
{
    static_cast<void>(poll(POLLIN, also));
}

void rpc_client::receive()
{
    while (!poll(POLLIN, -1))
        if (signal_ != 0 && !std::exchange(cancelled_, true))
            send_notification("cancel", {{"all", true}});
    char bytes[65536];
    const ssize_t n = ::recv(fd_.get(), bytes, sizeof bytes, MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return;
    if (n <= 0)
        throw error(error_kind::runtime, "server", "the connection ended", "see the messages of the server");
    buffer_.append(bytes, static_cast<std::size_t>(n));
}

std::optional<net::json> rpc_client::message()
{
    const std::size_t end = buffer_.find('\n');
    if (end == std::string::npos)
        return std::nullopt;
    net::json m = net::json::parse(buffer_.substr(0, end), nullptr, false);
    buffer_.erase(0, end + 1);
    if (!m.is_object())
        throw error(error_kind::runtime, "server", "it does not use this protocol",
                    "name the socket of a tactor serve");
    return m;
}

net::json rpc_client::answer(const std::string& method, const net::json& params)
{
    const int id = ++last_;
    send({{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}});
    for (;;) {
        for (auto m = message(); m; m = message()) {
            if (m->contains("method")) {
                notifications_.push_back(std::move(*m));
                continue;
            }
            if (m->contains("error") || (m->contains("id") && (*m)["id"] == id))
                return std::move(*m);
        }
        receive();
    }
}

net::json rpc_client::call(const std::string& method, const net::json& params)
{
    const net::json m = answer(method, params);
    if (m.contains("error"))
        throw make_error(m["error"]);
    return m.value("result", net::json::object());
}

bool rpc_client::try_call(const std::string& method, const net::json& params)
{
    const net::json m = answer(method, params);
    if (!m.contains("error"))
        return true;
    if (m["error"].value("code", 0) != net::code_limit)
        throw make_error(m["error"]);
    return false;
}

void rpc_client::send_notification(const std::string& method, const net::json& params)
{
    send({{"jsonrpc", "2.0"}, {"method", method}, {"params", params}});
}

std::optional<net::json> rpc_client::notification()
{
    if (notifications_.empty()) {
        pollfd p{fd_.get(), POLLIN, 0};
        if (::poll(&p, 1, 0) > 0)
            receive();
        for (auto m = message(); m; m = message()) {
            if (m->contains("error"))
                throw make_error((*m)["error"]);
            notifications_.push_back(std::move(*m));
        }
    }
    if (notifications_.empty())
        return std::nullopt;
    net::json first = std::move(notifications_.front());
    notifications_.pop_front();
    return first;
}

namespace {

struct status_options {
    std::optional<std::string> socket;
    bool watch = false;
    std::string format = "text";

    bool is_json_format() const { return format == "json"; }
};

void add_socket_option(CLI::App& c, std::optional<std::string>& into)
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
    if (s.contains("max_level_dbfs"))
        say(stdout, "ceiling    {} dBFS\n", plain_number(s.value("max_level_dbfs", 0.0), 4));
    say(stdout, "clients    {}\n", s.value("clients", 0));
    for (const net::json& c : s.value("who", net::json::array())) {
        const std::string name = c.value("name", "");
        const std::string from = c.value("from", "");
        say(stdout, "  {}{}{}\n", c.value("client", 0), name.empty() ? "" : " " + make_printable(name),
            from.empty() ? "" : " from " + make_printable(from));
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

// Prints notifications until the connection to the server ends. Throws interrupted.
void watch(rpc_client& server, const status_options& o)
{
    for (;;) {
        while (const auto n = server.notification()) {
            if (o.is_json_format())
                fmt::print("{}\n", net::json_line(*n));
            else
                print_event(*n);
            flush_output();
            if (std::ferror(stdout) != 0)
                return; // main() reports the error
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
    if (o.is_json_format())
        fmt::print("{}\n", net::json_line(s));
    else
        print_status(s);
    flush_output();
    if (o.watch)
        watch(server, o);
}

// Calls `ask`. A signal interrupts it even while the server does not reply.
template <typename F>
int run_until_interrupted(F ask)
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
    add_socket_option(line.app, o.socket);
    line.app.add_flag("--watch", o.watch, "print each change on a line until Ctrl-C");
    add_format_option(line.app, o.format, {"text", "json"}, "format of the output (default text)");
    line.app.footer("tactor status\n"
                    "tactor status --watch\n"
                    "tactor status --format json");
    line.parse();
    return run_until_interrupted([&](session::interrupt& stop) { status(o, stop); });
}

int run_stop(command_line& line)
{
    std::optional<std::string> socket;
    add_socket_option(line.app, socket);
    line.app.footer("tactor stop\n"
                    "tactor stop --socket /run/tactor/tactor.sock");
    line.parse();
    return run_until_interrupted([&](session::interrupt& stop) { rpc_client(socket, stop).call("stop"); });
}

} // namespace tactor::cli
