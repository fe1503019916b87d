// SPDX-License-Identifier: MIT
#include "engine/control/control_thread.hpp"

#include <array>
#include <atomic>
#include <utility>

#include <poll.h>

namespace tactor::engine {

struct control_thread::state {
    state(rt::event_fd& e, std::function<void()> w) : event(e), woken(std::move(w)) {}

    void run()
    {
        while (!over) {
            std::array<pollfd, 2> fds{{{event.fd(), POLLIN, 0}, {watched, POLLIN, 0}}};
            if (::poll(fds.data(), fds.size(), -1) < 0)
                continue;
            if (fds[0].revents != 0) {
                event.consume();
                woken();
            }
            if (!over && fds[1].revents != 0 && !readable())
                watched = -1;
        }
    }

    rt::event_fd& event;
    std::function<void()> woken;
    std::function<bool()> readable;
    std::atomic<int> watched{-1}; ///< poll() skips a negative descriptor
    std::atomic<bool> over{false};
};

control_thread::control_thread(rt::event_fd& e, std::function<void()> woken)
    : state_(std::make_shared<state>(e, std::move(woken))),
      // The program's handlers run here, so the stack is larger.
      thread_({.name = "tactor-control", .stack_bytes = std::size_t{512} * 1024}, [s = state_] { s->run(); })
{
}

control_thread::~control_thread()
{
    state_->over = true;
    if (thread_.is_current()) {
        thread_.detach();
        return;
    }
    state_->event.signal();
    thread_.join();
}

void control_thread::watch(int fd, std::function<bool()> readable)
{
    state_->readable = std::move(readable);
    state_->watched = fd;
    state_->event.signal();
}

} // namespace tactor::engine
