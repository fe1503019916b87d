// SPDX-License-Identifier: MIT
// A sink of your own: the frames go as UDP datagrams to a device with a DAC, e.g. a microcontroller.
//   udp_sink HOST PORT
// Each datagram is the number of its first frame (64 bits, little-endian), then 48 frames of 9 samples,
// S16_LE.
#include <cstdio>
#include <exception>
#include <memory>
#include <span>

#include <netdb.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <tactor/tactor.hpp>

namespace {

// paced_sink keeps the time; a sink for a device with its own clock derives from tactor::sink instead.
class udp_sink final : public tactor::paced_sink {
public:
    udp_sink(const tactor::stream_setup& s, const char* host, const char* port) : paced_sink(s)
    {
        addrinfo hints{};
        hints.ai_socktype = SOCK_DGRAM;
        addrinfo* found = nullptr;
        if (const int code = getaddrinfo(host, port, &hints, &found))
            throw tactor::error(tactor::error_kind::not_available, host, gai_strerror(code));
        fd_ = socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        const bool connected = connect(fd_, found->ai_addr, found->ai_addrlen) == 0;
        freeaddrinfo(found);
        if (!connected)
            throw tactor::error(tactor::error_kind::not_available, host, "it cannot be reached");
    }
    ~udp_sink() override { close(fd_); }

private:
    // In the audio thread: no waiting, no memory, no exceptions. A datagram for which there is no space in
    // the network is lost, as others are on their way; the number tells the other end.
    tactor::io_kind take(std::uint64_t first, std::span<const std::byte> frames) noexcept override
    {
        iovec parts[] = {{&first, sizeof first}, {const_cast<std::byte*>(frames.data()), frames.size()}};
        msghdr message{};
        message.msg_iov = parts;
        message.msg_iovlen = 2;
        sendmsg(fd_, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
        return tactor::io_kind::ok;
    }

    int fd_ = -1;
};

} // namespace

int main(int argc, char** argv)
try {
    if (argc != 3)
        return std::fprintf(stderr, "usage: udp_sink HOST PORT\n"), 2;
    const tactor::array palm = tactor::preset_array("palm-3x3");
    // Weak, for the first time: then come up in steps of 6 dB.
    const tactor::score score(palm, tactor::make_plan(palm, tactor::preset_stroke("park2016-1")),
                              {.level_dbfs = -40.0});

    tactor::stream_setup stream;
    stream.name = argv[1];
    stream.channels = score.channels();
    stream.rate = score.rate();
    stream.format = tactor::format_kind::s16;
    stream.period_frames = 48; // 1 ms, and a datagram that no network splits
    stream.buffer_frames = 480;
    tactor::player player(std::make_unique<udp_sink>(stream, argv[1], argv[2]), palm);
    const auto report = player.wait(player.submit(score));
    std::printf("%s\n", to_string(report->state).data());
    return report->state == tactor::state_kind::finished ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "udp_sink: %s\n", e.what());
    return 1;
}
