// SPDX-License-Identifier: MIT
// A browser's request, or the frames of a WebSocket after one that asks for it, through a pair of sockets.
#include <algorithm>
#include <string>

#include <boost/asio/io_context.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "holds.hpp"
#include "net/access.hpp"
#include "net/web.hpp"

using namespace tactor;

namespace {

constexpr std::string_view handshake =
    "GET /rpc HTTP/1.1\r\nHost: h\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";

void write_all(int fd, std::string_view bytes)
{
    HOLDS(::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()));
}

std::string read_all(int fd)
{
    std::string all;
    char some[4096];
    for (ssize_t n = 0; (n = ::recv(fd, some, sizeof some, MSG_DONTWAIT)) > 0;)
        all.append(some, static_cast<std::size_t>(n));
    return all;
}

void check_connection(std::string_view bytes, bool open)
{
    int ends[2];
    HOLDS(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0);
    int closed = 0;
    bool upgraded = false;
    std::string said;
    {
        boost::asio::io_context io(1);
        boost::asio::generic::stream_protocol::socket s(io, boost::asio::generic::stream_protocol(AF_UNIX, 0),
                                                        ends[0]);
        const net::message_limits limits{.message_bytes = 1024};
        const auto c = net::connect_browser(io, std::move(s), limits, {"h"});
        c->start({.message =
                      [&](std::string_view text) {
                          HOLDS(upgraded && !text.empty() && text.size() <= limits.message_bytes);
                          c->send("answer");
                          return text != "close";
                      },
                  .closed =
                      [&] {
                          ++closed;
                          io.stop(); // else it waits for times that nobody keeps
                      },
                  .get =
                      [](std::string_view, std::string_view host, std::string_view) {
                          HOLDS(host == "h" || host == "H" || host.starts_with("h:") ||
                                host.starts_with("H:") || host.starts_with("[h]") || host.starts_with("[H]"));
                          return net::web_reply{};
                      },
                  .upgrade = [&] { return upgraded = true; }});
        if (open) {
            // Frames come after the answer, as the standard has it.
            write_all(ends[1], handshake);
            while (said.empty()) {
                io.run_one();
                said = read_all(ends[1]);
            }
        }
        write_all(ends[1], bytes);
        ::shutdown(ends[1], SHUT_WR);
        io.run();
    }
    HOLDS(closed == 1);
    said += read_all(ends[1]);
    HOLDS(said.empty() || said.starts_with("HTTP/1.1 "));
    HOLDS(!open || said.starts_with("HTTP/1.1 101 "));
    ::close(ends[1]);
}

// Without a list nothing but localhost and addresses is ours, and only their own pages.
void check_names(std::string_view host, std::string_view origin)
{
    for (const char* local : {"127.0.0.1:4003", "[::1]:80"}) {
        const bool ours = net::is_server_host(host, local, {});
        HOLDS(!ours || host.find_first_not_of("0123456789abcdefABCDEF:.[]localhostLOCALHOST%") ==
                           std::string_view::npos);
        HOLDS(!ours || local[0] == '[' || host.ends_with(":4003")); // 80 need not be said
    }
    if (net::is_server_origin(origin, host, {}))
        HOLDS(origin.size() == host.size() + 7 && origin.starts_with("http://"));
    HOLDS(net::bearer_token(host).size() <= host.size());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0)
        return 0;
    const std::string_view rest = fuzz::as_text(data + 1, size - 1);
    switch (*data % 3) {
    case 0:
        check_connection(rest, false);
        break;
    case 1:
        check_connection(rest, true);
        break;
    default:
        check_names(rest.substr(0, rest.find('\n')),
                    rest.substr(std::min(rest.find('\n'), rest.size() - 1) + 1));
    }
    return 0;
}
