// SPDX-License-Identifier: MIT
#include "engine/control/amplifier_thread.hpp"

#include <poll.h>

#include "rt/clock.hpp"

namespace tactor::engine {

amplifier_thread::amplifier_thread(link& l, enable_line& line, const driver_options& o,
                                   const rt::thread_options& t)
    : link_(l), driver_(l, line, o, rt::monotonic_ns), thread_(t, [this] { run(); })
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
        sleep();
    }
    driver_.close();
    while (driver_.trying()) {
        sleep();
        driver_.update();
    }
}

void amplifier_thread::sleep() noexcept
{
    const timespec timeout = rt::to_timespec(driver_.next_ns());
    pollfd fd{.fd = link_.amplifier.wake.fd(), .events = POLLIN, .revents = 0};
    if (::ppoll(&fd, 1, &timeout, nullptr) > 0)
        link_.amplifier.wake.consume();
}

} // namespace tactor::engine
