// SPDX-License-Identifier: MIT
#include "engine/amplifier_thread.hpp"

#include <ctime>

#include <poll.h>

namespace tactor::engine {
namespace {

std::int64_t now_ns() noexcept
{
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

} // namespace

amplifier_thread::amplifier_thread(link& l, enable_line& line, const driver_options& o,
                                   const rt::thread_options& t)
    : link_(l), driver_(l, line, o, now_ns), thread_(t, [this] { run(); })
{
}

amplifier_thread::~amplifier_thread()
{
    over_.store(true, std::memory_order_release);
    link_.amplifier.wake.signal();
    thread_.join();
}

void amplifier_thread::run() noexcept
{
    while (!over_.load(std::memory_order_acquire)) {
        driver_.update();
        const std::int64_t t = driver_.next_ns();
        const timespec timeout{.tv_sec = static_cast<time_t>(t / 1'000'000'000),
                               .tv_nsec = static_cast<long>(t % 1'000'000'000)};
        pollfd fd{.fd = link_.amplifier.wake.fd(), .events = POLLIN, .revents = 0};
        if (::ppoll(&fd, 1, &timeout, nullptr) > 0)
            link_.amplifier.wake.consume();
    }
    driver_.close();
}

} // namespace tactor::engine
