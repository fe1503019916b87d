// SPDX-License-Identifier: MIT
#include "engine/audio_thread.hpp"

#include <ctime>
#include <latch>

namespace tactor::engine {
namespace {

std::int64_t now_ns() noexcept
{
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

} // namespace

audio_thread::audio_thread(audio_loop& loop, sink& s, link& l, const rt::thread_options& o)
    : loop_(loop), sink_(s), link_(l), fds_(s.max_descriptors() + 1)
{
    std::latch begun(1);
    // The thread itself starts the stream: ALSA's handle belongs to one thread, and between the start
    // and the first period nothing may come in between.
    thread_ = std::make_unique<rt::thread>(o, [this, &begun] {
        started_ = loop_.start(now_ns());
        begun.count_down();
        if (started_.status == io_status::ok)
            run();
    });
    begun.wait();
}

void audio_thread::run() noexcept
{
    while (!loop_.over()) {
        const io_status ready = wait();
        loop_.step(ready, now_ns());
    }
    link_.to_control.signal();
}

io_status audio_thread::wait() noexcept
{
    const bool asks_sink = loop_.polls_sink();
    const std::size_t n =
        asks_sink ? sink_.descriptors(std::span(fds_).first(fds_.size() - 1)) : std::size_t{0};
    fds_[n] = {.fd = link_.to_audio.fd(), .events = POLLIN, .revents = 0};

    const std::int64_t t = loop_.timeout_ns();
    const timespec timeout{.tv_sec = static_cast<time_t>(t / 1'000'000'000),
                           .tv_nsec = static_cast<long>(t % 1'000'000'000)};
    if (::ppoll(fds_.data(), n + 1, &timeout, nullptr) < 0)
        return io_status::again;
    if (fds_[n].revents != 0)
        link_.to_audio.consume();
    return asks_sink ? sink_.ready(std::span(fds_).first(n)) : io_status::again;
}

} // namespace tactor::engine
