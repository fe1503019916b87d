// SPDX-License-Identifier: MIT
/// \file
/// The sink as the audio loop calls it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <tactor/sink.hpp>

#include "rt/nonblocking.hpp"

namespace tactor::engine {

/// Wrapper whose calls may enter the kernel. ALSA locks a mutex of the handle in them, which only the audio
/// thread uses.
class device {
public:
    explicit device(sink& s) noexcept : sink_(s) {}

    io_kind prepare() noexcept
    {
        const rt::permitted_call here{};
        return sink_.prepare();
    }
    io_kind start() noexcept
    {
        const rt::permitted_call here{};
        return sink_.start();
    }
    io_kind resume() noexcept
    {
        const rt::permitted_call here{};
        return sink_.resume();
    }
    std::int64_t xrun_ns() noexcept
    {
        const rt::permitted_call here{};
        return sink_.xrun_ns();
    }
    io_result available() noexcept
    {
        const rt::permitted_call here{};
        return sink_.available();
    }
    io_result write(std::span<const std::byte> frames) noexcept
    {
        const rt::permitted_call here{};
        return sink_.write(frames);
    }
    stream_position position() noexcept
    {
        const rt::permitted_call here{};
        return sink_.position();
    }
    void drop() noexcept
    {
        const rt::permitted_call here{};
        return sink_.drop();
    }

private:
    sink& sink_;
};

} // namespace tactor::engine
