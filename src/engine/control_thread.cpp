// SPDX-License-Identifier: MIT
#include "engine/control_thread.hpp"

#include <utility>

#include <boost/asio/post.hpp>

namespace tactor::engine {

control_thread::control_thread(rt::event_fd& e, std::function<void()> woken)
    : event_(e),
      woken_(std::move(woken)),
      descriptor_(context_, e.fd()),
      // The handlers of the program run here, so the stack is not a small one.
      thread_({.name = "tactor-control", .stack_bytes = std::size_t{512} * 1024}, [this] {
          wait();
          context_.run();
      })
{
}

control_thread::~control_thread()
{
    context_.stop();
    thread_.join();
    boost::system::error_code ignored;
    // The descriptor would close what belongs to the eventfd.
    descriptor_.cancel(ignored);
    descriptor_.release();
    for (watched& w : watched_) {
        w.descriptor.cancel(ignored);
        w.descriptor.release();
    }
}

void control_thread::watch(int fd, std::function<bool()> readable)
{
    boost::asio::post(context_, [this, fd, f = std::move(readable)]() mutable {
        wait(watched_.emplace_back(
            watched{boost::asio::posix::stream_descriptor(context_, fd), std::move(f)}));
    });
}

void control_thread::wait(watched& w)
{
    w.descriptor.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                            [this, &w](const boost::system::error_code& failed) {
                                if (!failed && w.readable())
                                    wait(w);
                            });
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
