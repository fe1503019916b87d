// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <tactor/sink.hpp>

namespace bench {

using namespace tactor;

/// A sink that takes everything at once; it keeps the period written last.
class nowhere : public sink {
public:
    nowhere(unsigned channels, unsigned period)
    {
        setup_.name = "nowhere";
        setup_.channels = channels;
        setup_.rate = 48000;
        setup_.format = format_kind::s32;
        setup_.period_frames = period;
        setup_.buffer_frames = 3 * period;
        last_.resize(period * setup_.frame_bytes());
    }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override { return io_kind::ok; }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }
    std::size_t max_descriptors() const noexcept override { return 0; }
    std::size_t descriptors(std::span<pollfd>) noexcept override { return 0; }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override { return {io_kind::ok, setup_.period_frames, 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        std::memcpy(last_.data(), frames.data(), frames.size());
        const std::size_t n = frames.size() / setup_.frame_bytes();
        written_ += n;
        return {io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        const auto played = written_ - std::min<std::uint64_t>(written_, 2 * setup_.period_frames);
        return {written_, played, static_cast<std::int64_t>(played) * 20833, true};
    }
    void drop() noexcept override {}

    const std::vector<std::byte>& last() const noexcept { return last_; }

private:
    stream_setup setup_;
    std::vector<std::byte> last_;
    std::uint64_t written_ = 0;
};

} // namespace bench
