// SPDX-License-Identifier: MIT
// Strokes in a program on Boost.Asio: a UDP datagram names a preset, and is answered when it was felt.
//   asio_server PORT [PCM]         then: echo -n park2016-1 | socat - UDP:localhost:PORT; PORT 0 takes any
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>

#include <boost/asio.hpp>

#include <tactor/asio.hpp>
#include <tactor/tactor.hpp>

namespace {

namespace asio = boost::asio;
using asio::ip::udp;

// Plays a requested stroke and answers. The player's threads make the sound; this coroutine sleeps meanwhile
// and wakes up on its own executor, so that nothing in the program needs a lock.
asio::awaitable<void> draw(tactor::player& player, udp::socket& socket, udp::endpoint who, std::string name)
{
    std::string answer;
    try {
        const tactor::array palm = tactor::preset_array("palm-3x3");
        const tactor::plan plan = tactor::make_plan(palm, tactor::preset_stroke(name));
        const tactor::score score(palm, plan, {.level_dbfs = -40.0}); // weak: come up in steps of 6 dB
        const tactor::stroke_report report =
            co_await tactor::async_play(player, score, tactor::start_at::now(), asio::use_awaitable);
        answer = name + ": " + std::string(to_string(report.state));
    } catch (const tactor::error& e) {
        answer = e.what(); // no such preset; or the device has gone
    }
    co_await socket.async_send_to(asio::buffer(answer), who, asio::use_awaitable);
}

asio::awaitable<void> serve(tactor::player& player, udp::socket& socket)
{
    for (;;) {
        std::array<char, 256> text{};
        udp::endpoint who;
        const std::size_t n =
            co_await socket.async_receive_from(asio::buffer(text), who, asio::use_awaitable);
        // Strokes may overlap: the next request does not wait for this one.
        asio::co_spawn(socket.get_executor(), draw(player, socket, who, {text.data(), n}), asio::detached);
    }
}

} // namespace

int main(int argc, char** argv)
try {
    if (argc < 2)
        return std::fprintf(stderr, "usage: asio_server PORT [PCM]\n"), 2;
    asio::io_context context;
    const auto port = static_cast<std::uint16_t>(std::atoi(argv[1]));
    udp::socket socket(context, udp::endpoint(asio::ip::address_v4::loopback(), port));
    tactor::player player(
        tactor::open_alsa({.pcm = argc > 2 ? argv[2] : "null", .channels = 9, .wider = true}),
        tactor::preset_array("palm-3x3"));

    asio::signal_set signals(context, SIGINT, SIGTERM);
    signals.async_wait([&](auto, int) {
        player.stop(); // fades out: no stroke is cut off
        context.stop();
    });
    asio::co_spawn(context, serve(player, socket), asio::detached);
    std::printf("listening on port %d\n", socket.local_endpoint().port());
    std::fflush(stdout);
    context.run();
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "asio_server: %s\n", e.what());
    return 1;
}
