// SPDX-License-Identifier: MIT
/// \file
/// The thread of an amplifier_driver.
#pragma once

#include <atomic>

#include "engine/control/amplifier_driver.hpp"
#include "rt/thread.hpp"

namespace tactor::engine {

/// Woken by the audio thread, and by time.
class amplifier_thread {
public:
    /// \throws std::system_error when no thread can be started.
    amplifier_thread(link& l, enable_line& line, const driver_options& o, const rt::thread_options& t);
    /// Switches off, unless it is off already. Blocks while the line refuses and is tried again.
    ~amplifier_thread();
    amplifier_thread(const amplifier_thread&) = delete;
    amplifier_thread& operator=(const amplifier_thread&) = delete;

private:
    void run() noexcept;
    void sleep() noexcept;

    link& link_;
    amplifier_driver driver_;
    std::atomic<bool> over_{false};
    rt::thread thread_;
};

} // namespace tactor::engine
