// SPDX-License-Identifier: MIT
#include "server/server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/system/system_error.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "net/connection.hpp"
#include "net/osc.hpp"
#include "net/web.hpp"
#include "rt/clock.hpp"
#include "server/bhaptics.hpp"
#include "server/osc.hpp"

namespace tactor::server {
namespace {

using net::connection_fault;
using net::line_connection;
using net::listener;

namespace asio = boost::asio;
using socket_type = line_connection::socket_type;

// page/studio.html with its styles and modules, in one document.
constexpr net::page_document studio_page =
#include "server/studio_page.inc"
    ;

constexpr auto farewell = std::chrono::seconds(2); // time to send the last messages
constexpr std::string_view bhaptics_path = "/v2/feedbacks";
constexpr std::size_t short_visits = 32; // most simultaneous requests of browsers, in addition to clients

// Returns error -32001 with a null id, because it does not answer a request.
std::string refusal(std::string what, std::string why, std::string hint)
{
    return net::json_line(net::error_reply(
        nullptr, {net::code_limit, "limit", std::move(what), std::move(why), std::move(hint)}));
}

// Returns the message to a client that is refused because no descriptor is free.
std::string no_descriptor_message()
{
    return refusal("descriptors", "the server has too many open files", "try again later") + "\n";
}

// Returns the last message to a client that is disconnected after a fault. Returns "" if no message can be
// sent. `admitted` is true if the client has sent the right token or needs none.
std::string disconnect_message(connection_fault f, const service_limits& l, bool admitted)
{
    if (f == connection_fault::too_long)
        return refusal("max_message_bytes",
                       fmt::format("a message has more than {} bytes", l.max_message_bytes),
                       "send smaller messages");
    if (f == connection_fault::memory)
        return refusal("message", "there is not enough memory for it", "send smaller messages");
    if (f == connection_fault::too_slow && !admitted)
        return refusal("max_message_s",
                       fmt::format("no hello with the token came within {} s", l.max_message_s),
                       "begin with hello");
    if (f == connection_fault::too_slow)
        return refusal("max_message_s", fmt::format("no complete message came within {} s", l.max_message_s),
                       "send complete messages");
    return {};
}

using udp = asio::ip::udp;

/// OSC over UDP, with one socket for all senders.
class osc_endpoint {
public:
    /// Constructs an endpoint on `fd`, a bound socket, which the caller keeps open. Accepts packets from
    /// other machines only if `peers` contains them.
    osc_endpoint(asio::io_context& io, int fd, service& s, std::vector<net::address_prefix> peers)
        : service_(s),
          socket_(io, net::local_address(fd).starts_with('[') ? udp::v6() : udp::v4(), fd),
          due_(io),
          peers_(std::move(peers)),
          clients_(io, s,
                   {[this](const udp::endpoint& to, const std::string& packet) { send(to, packet); },
                    rt::monotonic_ns, rt::unix_ns})
    {
        socket_.non_blocking(true);
    }
    ~osc_endpoint()
    {
        boost::system::error_code ignored;
        socket_.release(ignored);
    }
    osc_endpoint(const osc_endpoint&) = delete;
    osc_endpoint& operator=(const osc_endpoint&) = delete;

    void start()
    {
        socket_.async_wait(udp::socket::wait_read, [this](const boost::system::error_code& e) {
            if (e)
                return;
            take();
            start();
        });
    }
    /// Stops receiving packets. Known senders are still notified when their strokes end.
    void stop()
    {
        boost::system::error_code ignored;
        socket_.cancel(ignored);
        due_.cancel();
        clients_.drop_held_strokes();
    }

private:
    // Handles one packet, then returns to the context so that other work can run.
    void take()
    {
        boost::system::error_code failed;
        udp::endpoint from;
        const std::size_t n = socket_.receive_from(asio::buffer(packet_), from, 0, failed);
        if (!failed && !net::is_accepted(from.address(), peers_))
            refuse(net::simplify_address(from.address()).to_string());
        else if (!failed)
            try {
                clients_.receive({packet_.data(), n}, from);
            } catch (const std::bad_alloc&) { // NOLINT(bugprone-empty-catch): datagrams may be lost
            }
        arm();
    }
    // Logs a refused machine the first time that it sends a packet.
    void refuse(const std::string& from)
    {
        if (refused_.size() < most_refused && refused_.insert(from).second)
            service_.clients().log_refusal(from, "a sender of OSC that osc_peers does not list");
    }
    void arm()
    {
        const auto next = clients_.next_ns();
        if (!next)
            return static_cast<void>(due_.cancel());
        due_.expires_at(std::chrono::steady_clock::time_point(std::chrono::nanoseconds(*next)));
        due_.async_wait([this](const boost::system::error_code& e) {
            if (e)
                return;
            try {
                clients_.process_pending();
            } catch (const std::bad_alloc&) { // NOLINT(bugprone-empty-catch): datagrams may be lost
            }
            arm();
        });
    }
    // Sends a datagram. If the system has no space for it, it is lost, as datagrams can be on the network.
    void send(const udp::endpoint& to, const std::string& packet)
    {
        boost::system::error_code lost;
        socket_.send_to(asio::buffer(packet), to, 0, lost);
    }

    static constexpr std::size_t largest_packet = 65536;
    static constexpr std::size_t most_refused = 1000;

    service& service_;
    std::set<std::string> refused_;
    udp::socket socket_;
    asio::steady_timer due_;
    std::vector<net::address_prefix> peers_;
    std::array<char, largest_packet> packet_{};
    osc_clients clients_;
};

class server {
public:
    server(asio::io_context& io, const endpoints& at, service_options o, stream_options s)
        : io_(io),
          limits_(o.limits),
          message_limits_{limits_.max_message_bytes, limits_.max_message_s, limits_.max_unread_bytes},
          allow_hosts_(at.allow_hosts),
          peers_(at.osc_peers),
          service_(io, std::move(o), std::move(s)),
          farewell_(io),
          watchdog_(io)
    {
        for (const auto& [fd, kind] :
             {std::pair(&at.socket, client_kind::local), {&at.tcp, client_kind::network}})
            if (*fd)
                listeners_.push_back(std::make_unique<listener>(
                    io, fd->get(), no_descriptor_message(),
                    [this, kind = kind](socket_type c) { take(std::move(c), kind); },
                    [this] { log_no_descriptor(); }));
        if (at.http)
            listeners_.push_back(std::make_unique<listener>(
                io, at.http.get(), net::no_descriptor_reply(),
                [this](socket_type c) { take_browser(std::move(c)); }, [this] { log_no_descriptor(); }));
        if (at.bhaptics)
            listeners_.push_back(std::make_unique<listener>(
                io, at.bhaptics.get(), net::no_descriptor_reply(),
                [this](socket_type c) { take_program(std::move(c)); }, [this] { log_no_descriptor(); }));
        if (at.osc)
            osc_.emplace(io, at.osc.get(), service_, at.osc_peers);
        service_.clients().on_all_sent([this](client_number n) { finish(n); });
    }

    void start(std::function<void()> ready)
    {
        service_.start();
        service_.output().call_when_ready(std::move(ready));
        for (const auto& l : listeners_)
            l->start();
        if (osc_)
            osc_->start();
        feed_watchdog();
    }

    void stop()
    {
        net::notify_manager("STOPPING=1");
        for (const auto& l : listeners_)
            l->stop();
        if (osc_)
            osc_->stop();
        watchdog_.cancel();
        service_.close([this] {
            for (const auto& [number, link] : std::map(links_))
                link->finish();
            for (const auto& c : std::set(visitors_))
                c->finish();
            closing_ = true;
            if (open_ == 0)
                return io_.stop();
            farewell_.expires_after(farewell);
            farewell_.async_wait([this](const boost::system::error_code& e) {
                if (!e)
                    io_.stop();
            });
        });
    }

private:
    void take(socket_type s, client_kind kind)
    {
        const int yes = 1;
        if (kind == client_kind::network)
            ::setsockopt(s.native_handle(), IPPROTO_TCP, 1 /* TCP_NODELAY */, &yes, sizeof yes);
        const std::string from = net::peer_address(s.native_handle());
        const auto c = std::make_shared<line_connection>(std::move(s), message_limits_);
        ++open_;
        if (!service_.clients().has_free_place(kind)) {
            c->start({.message = [](std::string_view) { return false; }, .closed = [this] { on_close(0); }});
            c->send(refusal("max_clients", places_taken_reason(kind), "try again later"));
            service_.clients().log_refusal(from, "a connection without a free place");
            return c->finish();
        }
        const client_number n = service_.connect(c, kind, from);
        links_.emplace(n, c);
        net::peer_handlers h = handlers(std::make_shared<client_number>(n));
        h.input_ended = [this, n] {
            if (service_.input_ended(n))
                finish(n);
        };
        h.fault = [this, n, from](connection_fault f) {
            const std::string why = disconnect_message(f, limits_, service_.clients().is_admitted(n));
            if (f != connection_fault::gone)
                service_.clients().log_refusal(from, f == connection_fault::too_slow
                                                         ? "a message that takes too long"
                                                         : "a message that is too large");
            if (const auto found = links_.find(n); found != links_.end() && !why.empty())
                found->second->send(why);
        };
        c->start(std::move(h));
    }

    // Returns the handlers of a connection. `*n` is the number of its client; it is 0 until a browser becomes
    // a client.
    net::peer_handlers handlers(const std::shared_ptr<client_number>& n)
    {
        return {.message = [this, n](std::string_view text) { return service_.receive(*n, text); },
                .closed = [this, n] { on_close(*n); },
                .met = [this, n] { return service_.clients().is_admitted(*n); },
                .large =
                    [this, n](std::string text, std::function<void(bool)> done) {
                        service_.receive_large_message(*n, std::move(text), std::move(done));
                    }};
    }

    std::string places_taken_reason(client_kind kind)
    {
        const std::size_t kept = limits_.max_clients - service_.clients().places(kind);
        return fmt::format("all {} places for clients are taken{}", limits_.max_clients,
                           kept == 0 ? "" : fmt::format(", {} of them only for this machine's socket", kept));
    }

    void log_no_descriptor()
    {
        service_.clients().log_refusal("somebody", "a connection without a free descriptor");
    }

    void finish(client_number n)
    {
        if (const auto found = links_.find(n); found != links_.end())
            found->second->finish();
    }

    // Accepts a connection from a browser. The browser becomes a client when it opens a WebSocket.
    void take_browser(socket_type s)
    {
        const std::string from = net::peer_address(s.native_handle());
        const auto c = admit_browser(std::move(s), from, "/rpc");
        if (!c)
            return;
        const auto n = std::make_shared<client_number>(0);
        net::peer_handlers h = handlers(n);
        h.closed = make_close_handler(c, n);
        h.get = [this, from](std::string_view path, std::string_view host, std::string_view token) {
            return page(path, host, token, from);
        };
        h.refused = [this, from](const std::string& why) { service_.clients().log_refusal(from, why); };
        h.upgrade = [this, n, from, weak = std::weak_ptr(c)] {
            if (!has_free_place(client_kind::web, from))
                return false;
            const auto link = weak.lock();
            *n = service_.connect(link, client_kind::web, from);
            links_.emplace(*n, link);
            return true;
        };
        c->start(std::move(h));
    }

    // Accepts a program for the bHaptics player, by its WebSocket.
    void take_program(socket_type s)
    {
        const std::string from = net::peer_address(s.native_handle());
        boost::system::error_code gone;
        const auto address = asio::ip::make_address(from, gone);
        if (gone || !net::is_accepted(address, peers_))
            return service_.clients().log_refusal(from, "a program that osc_peers does not list");
        const auto c = admit_browser(std::move(s), from, bhaptics_path);
        if (!c)
            return;
        const auto n = std::make_shared<client_number>(0);
        const auto program = std::make_shared<std::weak_ptr<bhaptics_program>>();
        const auto receive = [program](std::string text, std::function<void(bool)> done) {
            if (const auto p = program->lock())
                p->receive(std::move(text), std::move(done));
        };
        net::peer_handlers h{
            .message = [receive](std::string_view text) { return receive(std::string(text), {}), true; },
            .closed = make_close_handler(c, n),
            .large = receive};
        h.may_only_read = true;
        h.get = [](std::string_view, std::string_view, std::string_view) {
            return net::web_reply{404, "text/plain", fmt::format("this server has only {}\n", bhaptics_path),
                                  ""};
        };
        h.refused = [this, from](const std::string& why) { service_.clients().log_refusal(from, why); };
        h.upgrade = [this, n, from, program, weak = std::weak_ptr(c)] {
            if (!has_free_place(client_kind::bhaptics, from))
                return false;
            const auto p =
                std::make_shared<bhaptics_program>(io_, service_, weak.lock(), limits_.max_nesting);
            *program = p;
            *n = service_.connect(p, client_kind::bhaptics, from);
            links_.emplace(*n, p);
            p->begin(*n);
            return true;
        };
        c->start(std::move(h));
    }

    // Returns the connection of a browser, or of a program that speaks like one; null if there is no place.
    std::shared_ptr<net::connection> admit_browser(socket_type s, const std::string& from,
                                                   std::string_view path)
    {
        if (visitors_.size() >= limits_.max_clients + short_visits) {
            service_.clients().log_refusal(from, "a browser without a free place");
            net::reject_client(s.native_handle()); // the socket closes at the end of the scope
            return nullptr;
        }
        auto c = net::connect_browser(io_, std::move(s), message_limits_, allow_hosts_, path);
        if (c) {
            ++open_;
            visitors_.insert(c);
        }
        return c;
    }

    // Returns the function to call when the connection of a browser or program has closed.
    std::function<void()> make_close_handler(const std::shared_ptr<net::connection>& c,
                                             const std::shared_ptr<client_number>& n)
    {
        return [this, n, weak = std::weak_ptr(c)] {
            visitors_.erase(weak.lock());
            on_close(*n);
        };
    }

    bool has_free_place(client_kind kind, const std::string& from)
    {
        const bool has = service_.clients().has_free_place(kind);
        if (!has)
            service_.clients().log_refusal(from, "a browser without a free place");
        return has;
    }

    net::web_reply page(std::string_view path, std::string_view host, std::string_view token,
                        const std::string& from)
    {
        if (path == "/")
            return net::make_page(studio_page, host);
        if (path != "/status")
            return {404, "text/plain", "this server has only /, /rpc and /status\n", ""};
        if (token.empty() && !service_.clients().accepts_token(token))
            service_.clients().log_refusal(from, "no token");
        if (!service_.clients().accepts_token(token))
            return {401, "text/plain", "a token is required: Authorization: Bearer TOKEN\n",
                    "",  "",           token.empty() ? 0.0 : service_.clients().count_wrong_token(from)};
        return {200, "application/json", net::json_line(service_.status_json()) + "\n", ""};
    }

    void on_close(client_number n)
    {
        --open_;
        service_.disconnect(n);
        links_.erase(n);
        if (closing_ && open_ == 0)
            io_.stop();
    }

    // Notifies the service manager at least twice per watchdog interval if the audio thread makes progress.
    void feed_watchdog()
    {
        const char* us = std::getenv("WATCHDOG_USEC");
        const double seconds =
            us == nullptr ? 0.0 : static_cast<double>(std::strtoll(us, nullptr, 10)) * 1e-6;
        if (seconds <= 0.0)
            return;
        if (service_.output().has_progressed())
            net::notify_manager("WATCHDOG=1");
        watchdog_.expires_after(std::chrono::microseconds(static_cast<long long>(seconds * 0.4e6)));
        watchdog_.async_wait([this](const boost::system::error_code& e) {
            if (!e)
                feed_watchdog();
        });
    }

    asio::io_context& io_;
    service_limits limits_;
    net::message_limits message_limits_;
    std::vector<std::string> allow_hosts_;
    std::vector<net::address_prefix> peers_;
    service service_;
    std::optional<osc_endpoint> osc_;
    std::vector<std::unique_ptr<listener>> listeners_;
    std::map<client_number, std::shared_ptr<client_link>> links_;
    std::set<std::shared_ptr<net::connection>> visitors_;
    asio::steady_timer farewell_;
    asio::steady_timer watchdog_;
    std::size_t open_ = 0;
    bool closing_ = false;
};

// A name for inherited sockets, and the check for the kind of socket that has this name.
struct inheritable {
    std::string_view name;
    net::owned_fd endpoints::*place;
    bool (*fits)(int fd);
    const char* otherwise;
};

constexpr std::array known{
    inheritable{"socket", &endpoints::socket, net::is_unix_listener, "it is not a listening Unix socket"},
    inheritable{"tcp", &endpoints::tcp, net::is_tcp_listener, "it is not a listening TCP socket"},
    inheritable{"http", &endpoints::http, net::is_tcp_listener, "it is not a listening TCP socket"},
    inheritable{"bhaptics", &endpoints::bhaptics, net::is_tcp_listener, "it is not a listening TCP socket"},
    inheritable{"osc", &endpoints::osc, net::is_bound_udp, "it is not a UDP socket with a port"},
};

// Refuses a socket that every user may write to, because users who can write to it can play strokes.
void check_private(const std::string& path)
{
    struct stat is {};
    const bool named = !path.empty() && ::stat(path.c_str(), &is) == 0;
    if (!named || (is.st_mode & S_IWOTH) != 0)
        throw error(error_kind::bad_input, "inherited socket \"socket\"" + (named ? " " + path : ""),
                    named ? "every user of this machine may write to it"
                          : "it is not a file, so no mode limits who may draw",
                    "set SocketMode=0660 and SocketGroup= in the .socket unit");
}

[[noreturn]] void refuse_osc(const char* what)
{
    throw error(error_kind::bad_input, what, "this build has no OSC",
                "build tactor with liblo and -Dosc=enabled");
}

std::optional<std::pair<dev_t, ino_t>> find_file_id(const std::string& path) noexcept
{
    struct stat is {};
    if (::lstat(path.c_str(), &is) != 0)
        return {};
    return std::pair(is.st_dev, is.st_ino);
}

} // namespace

void serve(const endpoints& at, service_options o, stream_options s, int signals,
           const std::function<void()>& listening)
try {
    asio::io_context io(1);
    // Keeps the context running until stop(), even while no client is connected and while the stream fades
    // out.
    const auto until_stopped = asio::make_work_guard(io);
    std::exception_ptr refused;
    s.refused = [&](std::exception_ptr e) {
        refused = std::move(e);
        io.stop();
    };
    server all(io, at, std::move(o), std::move(s));
    // Raises the priority of this thread above its clients and above the planner threads, if the system
    // allows it. On Linux, this call sets the priority of the calling thread only.
    constexpr int before_others = -10;
    ::setpriority(PRIO_PROCESS, 0, before_others);
    asio::posix::stream_descriptor signal_input(io, copy_descriptor(signals));
    signal_input.async_wait(asio::posix::descriptor_base::wait_read, [&](const boost::system::error_code& e) {
        if (!e)
            all.stop();
    });
    // Accepts clients only after the first attempt to open the device, so that clients see the true state of
    // the stream.
    all.start([&] {
        listening();
        net::notify_manager("READY=1");
    });
    io.run();
    if (refused != nullptr)
        std::rethrow_exception(refused);
} catch (const error&) {
    throw;
} catch (const boost::system::system_error& e) {
    detail::throw_resource_error("service", e.code().value(), e.what());
} catch (const std::system_error& e) {
    detail::throw_resource_error("service", e.code().value(), e.what());
}

std::string read_token(const options::serve_settings& s)
{
    if (!s.token_file)
        return {};
    const std::string& file = *s.token_file;
    const net::owned_fd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat is {};
    if (!fd || ::fstat(fd.get(), &is) != 0)
        throw error(error_kind::bad_input, "token_file " + file, std::strerror(errno),
                    "name a file with the token on its first line");
    if (!S_ISREG(is.st_mode) || (is.st_mode & S_IRWXO) != 0)
        throw error(error_kind::bad_input, "token_file " + file,
                    S_ISREG(is.st_mode) ? "other users may read it" : "it is not a regular file",
                    "run chmod 600 on the file, and choose another token");
    char bytes[4097];
    const ssize_t n = ::read(fd.get(), bytes, sizeof bytes);
    const std::string all(bytes, n > 0 ? static_cast<std::size_t>(n) : 0);
    std::string token = all.substr(0, all.find_first_of("\r\n"));
    if (token.empty() || token.size() == sizeof bytes)
        throw error(error_kind::bad_input, "token_file " + file, "its first line is not a token",
                    "use 1 to 4096 bytes, such as the output of openssl rand -hex 32");
    return token;
}

endpoints open_endpoints(const endpoint_options& o)
{
    endpoints e;
    e.allow_hosts = o.allow_hosts;
    for (const std::string& p : o.osc_peers)
        e.osc_peers.push_back(net::parse_prefix(p));
    for (auto& [name, fd] : net::take_inherited_sockets()) {
        const auto k =
            std::find_if(known.begin(), known.end(), [&n = name](const auto& x) { return x.name == n; });
        if (k == known.end())
            throw error(error_kind::bad_input, "inherited socket \"" + name + "\"", "it is unknown",
                        "set FileDescriptorName=socket, tcp, http, osc or bhaptics");
        if (!k->fits(fd.get()))
            throw error(error_kind::bad_input, "inherited socket \"" + name + "\"", k->otherwise,
                        "see the .socket unit");
        if (name == "osc" && !net::has_osc_support())
            refuse_osc("inherited socket \"osc\"");
        if (e.*k->place)
            throw error(error_kind::bad_input, "inherited socket \"" + name + "\"",
                        "two sockets have this name",
                        "use one ListenStream= or ListenDatagram= for each FileDescriptorName=");
        e.*k->place = std::move(fd);
    }
    if (e.socket) {
        e.socket_path = net::bound_path(e.socket.get());
        check_private(e.socket_path);
    } else {
        e.socket_path = o.socket();
        if (!e.socket_path.empty()) {
            e.socket = net::listen_unix(e.socket_path, o.mode, o.group);
            e.own_socket = find_file_id(e.socket_path);
        }
    }
    try {
        if (!e.tcp && o.tcp)
            e.tcp = net::listen_tcp(*o.tcp, "tcp");
        if (!e.http && o.http)
            e.http = net::listen_tcp(*o.http, "http");
        if (!e.bhaptics && o.bhaptics)
            e.bhaptics = net::listen_tcp(*o.bhaptics, "bhaptics");
        if (!e.osc && o.osc) {
            if (!net::has_osc_support())
                refuse_osc("osc");
            e.osc = net::bind_udp(*o.osc, "osc");
        }
    } catch (...) {
        remove_socket(e);
        throw;
    }
    for (const auto& [fd, address] :
         {std::pair(&e.tcp, &e.tcp_address), std::pair(&e.http, &e.http_address),
          std::pair(&e.osc, &e.osc_address), std::pair(&e.bhaptics, &e.bhaptics_address)})
        if (*fd)
            *address = net::local_address(fd->get());
    return e;
}

void remove_socket(const endpoints& at) noexcept
{
    if (at.own_socket && find_file_id(at.socket_path) == at.own_socket)
        ::unlink(at.socket_path.c_str());
}

} // namespace tactor::server
