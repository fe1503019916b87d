// SPDX-License-Identifier: MIT
/// \file
/// The control thread, which the audio thread wakes.
#pragma once

#include <functional>
#include <memory>

#include "rt/event_fd.hpp"
#include "rt/thread.hpp"

namespace tactor::engine {

/// A thread that calls `woken` for each signal of an eventfd, and watches one more descriptor.
class control_thread {
public:
    /// Starts the thread.
    /// \throws std::system_error when the system refuses threads.
    control_thread(rt::event_fd& e, std::function<void()> woken);
    /// Ends the thread; it does not call `woken` and `readable` any more. If one of these destroys this
    /// object in the thread itself, the destructor returns at once, and the thread ends when they have
    /// returned. The event and the descriptor may be gone by then.
    ~control_thread();
    control_thread(const control_thread&) = delete;
    control_thread& operator=(const control_thread&) = delete;

    /// Calls `readable` in the control thread whenever a descriptor is readable, until it returns false. The
    /// caller keeps the descriptor, which must live as long as this object. Call it once.
    void watch(int fd, std::function<bool()> readable);

    bool is_current() const noexcept { return thread_.is_current(); }

private:
    struct state;

    std::shared_ptr<state> state_; ///< shared with the thread, which may outlive this object for a moment
    rt::thread thread_;
};

} // namespace tactor::engine
