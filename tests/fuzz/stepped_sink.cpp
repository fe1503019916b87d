// SPDX-License-Identifier: MIT
#include "stepped_sink.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>
#include <utility>

#include <poll.h>

#include "rt/event_fd.hpp"

namespace tactor::fuzz {

struct stepped_clock::state {
    explicit state(stream_setup s) : setup(std::move(s)) {}

    stream_setup setup;
    std::atomic<std::uint64_t> due{0};  ///< frames that the DAC may have played
    std::atomic<std::uint64_t> seen{0}; ///< `due` as the audio thread last handled it
    rt::event_fd moved;

    std::int64_t time_ns(std::uint64_t frames) const noexcept
    {
        constexpr std::int64_t begin_ns = 1'000'000'000'000;
        return begin_ns + static_cast<std::int64_t>(1'000'000'000 * frames / setup.rate);
    }
};

class stepped_clock::stepped_sink final : public sink {
public:
    explicit stepped_sink(std::shared_ptr<state> s) : state_(std::move(s)) {}

    const stream_setup& setup() const noexcept override { return state_->setup; }
    io_kind prepare() noexcept override
    {
        from_ = looked_;
        written_ = 0;
        return io_kind::ok;
    }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }

    std::size_t max_descriptors() const noexcept override { return 1; }
    std::size_t descriptors(std::span<pollfd> fds) noexcept override
    {
        // The audio thread has published everything of its last wake-up.
        state_->seen.store(looked_, std::memory_order_release);
        state_->seen.notify_one();
        fds[0] = {.fd = state_->moved.fd(), .events = POLLIN, .revents = 0};
        return 1;
    }
    io_kind ready(std::span<pollfd>) noexcept override
    {
        state_->moved.consume();
        return room() >= state_->setup.period_frames ? io_kind::ok : io_kind::again;
    }

    io_result available() noexcept override { return {io_kind::ok, static_cast<std::size_t>(room()), 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const std::size_t n = std::min<std::size_t>(frames.size() / state_->setup.frame_bytes(),
                                                    static_cast<std::size_t>(room()));
        written_ += n;
        return {n == 0 ? io_kind::again : io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        looked_ = state_->due.load(std::memory_order_acquire);
        return {written_, played(looked_), state_->time_ns(looked_), true};
    }
    void drop() noexcept override {}

private:
    // A DAC without frames waits for more, so there are no xruns.
    std::uint64_t played(std::uint64_t due) const noexcept { return std::min(due - from_, written_); }
    std::uint64_t room() const noexcept
    {
        return state_->setup.buffer_frames - (written_ - played(state_->due.load(std::memory_order_acquire)));
    }

    std::shared_ptr<state> state_;
    std::uint64_t from_ = 0;    ///< `due` at the epoch's start
    std::uint64_t looked_ = 0;  ///< `due` of the last position
    std::uint64_t written_ = 0; ///< in this epoch
};

stepped_clock::stepped_clock(stream_setup s) : state_(std::make_shared<state>(std::move(s)))
{
}

stepped_clock::~stepped_clock() = default;

std::unique_ptr<sink> stepped_clock::make_sink()
{
    return std::make_unique<stepped_sink>(state_);
}

void stepped_clock::step()
{
    const std::uint64_t due = state_->due.load() + state_->setup.period_frames;
    state_->due.store(due, std::memory_order_release);
    state_->moved.signal();
    for (std::uint64_t seen = state_->seen.load(); seen < due; seen = state_->seen.load())
        state_->seen.wait(seen);
}

std::int64_t stepped_clock::now_ns() const noexcept
{
    return state_->time_ns(state_->due.load(std::memory_order_acquire));
}

} // namespace tactor::fuzz
