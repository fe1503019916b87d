// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <utility>

#include "rig.hpp"

namespace tactor::test {

/// Checks every sample that the device takes, and refuses writes at random.
class checking_sink : public forwarding_sink {
public:
    static constexpr unsigned channels = 4;

    /// `limit`: greatest magnitude; `allowed`: greatest change from frame to frame, read anew each time.
    checking_sink(std::unique_ptr<sink> s, std::mt19937_64& random, double limit, const double& allowed)
        : forwarding_sink(std::move(s)), random_(random), limit_(limit), allowed_(allowed)
    {
    }

    io_kind prepare() noexcept override
    {
        empty_ = true;
        before_.fill(0.0); // the device made a gap: from zero
        return forwarding_sink::prepare();
    }

    io_result write(std::span<const std::byte> frames) noexcept override
    {
        std::size_t n = frames.size() / setup().frame_bytes();
        // An empty buffer always takes something.
        switch (empty_ ? 63 : random_() % 64) {
        case 0:
            return {io_kind::again, 0, 0};
        case 1:
            return {io_kind::ok, 0, 0};
        case 2:
            n = 1 + random_() % n; // short
            break;
        default:
            break;
        }
        const io_result r = write_first(n, frames);
        empty_ = false;
        for (std::size_t f = 0; f < r.frames; ++f) {
            for (unsigned c = 0; c < channels; ++c) {
                std::int32_t v = 0;
                std::memcpy(&v, frames.data() + (f * channels + c) * 4, 4);
                const double x = v / 2147483648.0;
                beyond_limit += std::abs(x) > limit_ + 1e-9 ? 1U : 0U;
                jumps += std::abs(x - before_[c]) > allowed_ + 1e-6 ? 1U : 0U;
                loudest = std::max(loudest, std::abs(x));
                before_[c] = x;
            }
        }
        return r;
    }

    std::uint64_t beyond_limit = 0;
    std::uint64_t jumps = 0;
    double loudest = 0.0;

private:
    std::mt19937_64& random_;
    double limit_;
    const double& allowed_;
    std::array<double, channels> before_{};
    bool empty_ = true;
};

} // namespace tactor::test
