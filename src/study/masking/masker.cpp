// SPDX-License-Identifier: MIT
#include "study/masking/masker.hpp"

#include <chrono>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::study {
namespace {

constexpr int look_ms = 20;          // interval of looks at a stream that stands still
constexpr int masking_priority = 60; // below the array's audio thread

} // namespace

masker::masker(std::unique_ptr<sink> s, const masking_options& o)
    : sink_(std::move(s)),
      patience_(o.patience_s + o.fade_s),
      stream_(*sink_, o),
      fds_(sink_->max_descriptors() + 1)
{
    if (const io_kind k = stream_.begin(); k != io_kind::ok)
        throw error(error_kind::runtime, sink_->setup().name,
                    fmt::format("the masking noise does not start: {}", to_string(k)));
    thread_ = std::make_unique<rt::thread>(
        rt::thread_options{.name = "tactor-masker", .fifo = true, .priority = masking_priority},
        [this] { run(); });
}

masker::~masker()
{
    over_ = true;
    wake_.signal();
    thread_.reset();
    sink_->drop();
}

void masker::want(bool on) noexcept
{
    on_ = on;
    // The old state is over, also before the thread has looked.
    if (ended_ == io_kind::ok)
        state_ = masking_state::fading;
    wake_.signal();
}

bool masker::poll_descriptor(int descriptor, int timeout_ms)
{
    pollfd p{.fd = descriptor, .events = POLLIN, .revents = 0};
    ::poll(&p, 1, timeout_ms);
    return true;
}

bool masker::wait_for(masking_state s, const waiter& wait)
{
    const auto until = std::chrono::steady_clock::now() + patience_;
    for (;;) {
        // The state before the time: it may have come while this thread had no processor.
        const bool late = std::chrono::steady_clock::now() >= until;
        if (ended_ != io_kind::ok)
            return false;
        if (state_ == s)
            return true;
        if (late || !wait(changed_.fd(), look_ms))
            return false;
        changed_.consume();
    }
}

io_kind masker::wait() noexcept
{
    const std::size_t n = sink_->descriptors(std::span(fds_).first(fds_.size() - 1));
    fds_[n] = {.fd = wake_.fd(), .events = POLLIN, .revents = 0};
    if (::poll(fds_.data(), n + 1, look_ms) < 0)
        return io_kind::again;
    if (fds_[n].revents != 0)
        wake_.consume();
    return sink_->ready(std::span(fds_).first(n));
}

void masker::run() noexcept
{
    while (!over_) {
        const io_kind ready = wait();
        const bool on = on_;
        const io_kind now = stream_.step(ready, on);
        breaks_ = stream_.breaks();
        if (now != io_kind::ok) {
            ended_ = now;
            changed_.signal();
            return;
        }
        const masking_state is = stream_.state();
        // A state other than the wanted one is not final, if the wish has changed meanwhile.
        if (is != (on ? masking_state::silent : masking_state::full) && state_.exchange(is) != is)
            changed_.signal();
    }
}

} // namespace tactor::study
