// SPDX-License-Identifier: MIT
#include "engine/control/control_thread.hpp"

#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <sys/epoll.h>

#include "core/owned.hpp"

namespace tactor::engine {
namespace {

using boost::asio::posix::stream_descriptor;

// Throws if a descriptor cannot be polled. Asio accepts files and devices that are always readable, and fails
// only when it waits for one.
void check_waitable(int fd)
{
    const detail::owned_fd set(::epoll_create1(EPOLL_CLOEXEC));
    if (!set)
        throw std::system_error(errno, std::generic_category(), "epoll");
    epoll_event wanted{};
    wanted.events = EPOLLIN;
    const int code = ::epoll_ctl(set.get(), EPOLL_CTL_ADD, fd, &wanted) < 0 ? errno : 0;
    if (code != 0)
        throw std::system_error(code, std::generic_category());
}

// Releases the descriptor, which belongs to somebody else.
void let_go(stream_descriptor& d) noexcept
{
    boost::system::error_code ignored;
    d.cancel(ignored);
    d.release();
}

} // namespace

struct control_thread::state {
    state(rt::event_fd& e, std::function<void()> w)
        : event(e), woken(std::move(w)), descriptor(context, e.fd())
    {
    }
    ~state() { end(); } // also if the thread could not start
    state(const state&) = delete;
    state& operator=(const state&) = delete;

    void wait()
    {
        descriptor.async_wait(stream_descriptor::wait_read, [this](const boost::system::error_code& failed) {
            if (failed)
                return;
            event.consume();
            woken();
            if (!over)
                wait();
        });
    }

    void wait_for_watched()
    {
        watched->async_wait(stream_descriptor::wait_read, [this](const boost::system::error_code& failed) {
            if (!failed && readable() && !over)
                wait_for_watched();
        });
    }

    void end() noexcept
    {
        over = true;
        let_go(descriptor);
        if (watched)
            let_go(*watched);
    }

    rt::event_fd& event;
    std::function<void()> woken;
    std::function<bool()> readable;
    boost::asio::io_context context;
    stream_descriptor descriptor;
    std::optional<stream_descriptor> watched;
    bool over = false; ///< used by the thread only
};

control_thread::control_thread(rt::event_fd& e, std::function<void()> woken)
    : state_(std::make_shared<state>(e, std::move(woken))),
      // The program's handlers run here, so the stack is larger.
      thread_({.name = "tactor-control", .stack_bytes = std::size_t{512} * 1024}, [s = state_] {
          s->wait();
          s->context.run();
      })
{
}

control_thread::~control_thread()
{
    state_->context.stop();
    if (thread_.is_current()) {
        thread_.detach();
        state_->end();
        return;
    }
    thread_.join();
    state_->end();
}

void control_thread::watch(int fd, std::function<bool()> readable)
{
    check_waitable(fd);
    state_->readable = std::move(readable);
    state_->watched.emplace(state_->context, fd);
    boost::asio::post(state_->context, [s = state_.get()] { s->wait_for_watched(); });
}

} // namespace tactor::engine
