// SPDX-License-Identifier: MIT
// Draws through `tactor serve`, beside other programs: a preset, then a circle point by point.
//   serve_client [SOCKET]     default: where a user's service listens, $XDG_RUNTIME_DIR/tactor.sock
// Needs Boost.Asio and nothing of tactor; the protocol is in tactor-protocol(7).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>

#include <boost/asio/local/stream_protocol.hpp>

namespace {

using stream = boost::asio::local::stream_protocol::iostream;
/// Sends one request and returns the line that answers it.
std::string call(stream& server, const std::string& method, const std::string& params)
{
    server << R"({"jsonrpc":"2.0","id":1,"method":")" << method << R"(","params":)" << params << "}"
           << std::endl;
    std::string line;
    while (std::getline(server, line))
        if (line.find(R"("id":1,)") != std::string::npos)
            break;
    if (!server || line.find(R"("error":)") != std::string::npos)
        throw std::runtime_error(server ? line : "the service has gone");
    return line;
}

std::string find_stroke(const std::string& reply)
{
    const std::size_t at = reply.find(R"("stroke":)") + 9;
    return reply.substr(at, reply.find_first_not_of("0123456789", at) - at);
}

/// Waits for the end of a stroke; each has exactly one.
std::string wait(stream& server, const std::string& stroke)
{
    for (std::string line; std::getline(server, line);)
        if (line.find(R"("stroke":)" + stroke + ",") != std::string::npos)
            for (const char* end : {"finished", "cancelled", "interrupted"})
                if (line.find(end) != std::string::npos)
                    return end;
    throw std::runtime_error("the service has gone");
}

} // namespace

int main(int argc, char** argv)
try {
    const char* folder = std::getenv("XDG_RUNTIME_DIR");
    const std::string path = argc > 1 ? argv[1] : std::string(folder ? folder : "/run") + "/tactor.sock";
    stream server{boost::asio::local::stream_protocol::endpoint(path)};
    if (!server)
        throw std::runtime_error(path + ": " + server.error().message());
    const std::string played =
        find_stroke(call(server, "play", R"({"stroke":"park2016-1","options":{"duration":0.7}})"));
    std::printf("park2016-1: %s\n", wait(server, played).c_str());

    const std::string live = find_stroke(call(server, "begin", R"({"timeout_s":60})"));
    for (int i = 0; i < 100; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 100;
        server << R"({"jsonrpc":"2.0","method":"to","params":{"stroke":)" << live << R"(,"x_mm":)"
               << 20 + 10 * std::cos(angle) << R"(,"y_mm":)" << 20 + 10 * std::sin(angle) << "}}"
               << std::endl;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    call(server, "end", R"({"stroke":)" + live + "}");
    std::printf("circle: %s\n", wait(server, live).c_str());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "serve_client: %s\n", e.what());
    return 1;
}
