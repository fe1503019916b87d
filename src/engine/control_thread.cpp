// SPDX-License-Identifier: MIT
#include "engine/control_thread.hpp"

#include <utility>

namespace tactor::engine {

control_thread::control_thread(rt::event_fd& e, std::function<void()> woken)
    : event_(e),
      woken_(std::move(woken)),
      descriptor_(context_, e.fd()),
      // The handlers of the program run here, so the stack is not a small one.
      thread_({.name = "tactor-control", .stack_bytes = 1024 * 1024}, [this] {
          wait();
          context_.run();
      })
{
}

control_thread::~control_thread()
{
    context_.stop();
    thread_.join();
    // The descriptor would close what belongs to the eventfd.
    descriptor_.cancel();
    descriptor_.release();
}

void control_thread::wait()
{
    descriptor_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                           [this](const boost::system::error_code& failed) {
                               if (failed)
                                   return;
                               event_.consume();
                               woken_();
                               wait();
                           });
}

} // namespace tactor::engine
