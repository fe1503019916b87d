// SPDX-License-Identifier: MIT
/// \file
/// What is measured, and what it is measured against.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactor/tactor.hpp>

namespace bench {

/// Frames that one call renders: 10 ms.
inline constexpr std::size_t block = 480;

/// park2016-1 on the palm, over and over.
tactor::score palm();

/// 64 strokes at once on an 8 x 8 array, each on tactors of its own, over and over.
tactor::score field();

/// 64 strokes for an 8 x 8 array, each on tactors of its own and with its own carrier.
std::vector<tactor::score> strokes_64();

/// What one would write first: a call of std::sin for each sounding channel and sample.
class plain_loop {
public:
    explicit plain_loop(const tactor::score& s);
    void process(std::size_t frames, float* out);
    bool at_end() const { return position_ >= frames_; }

private:
    struct tone {
        std::uint64_t start;
        std::uint64_t end;
        unsigned channel;
        double amplitude;
        double hz;
    };
    std::vector<tone> tones_; ///< by start
    std::size_t first_ = 0;
    std::uint64_t longest_ = 0;
    std::uint64_t position_ = 0;
    std::uint64_t frames_;
    unsigned channels_;
    double rate_;
};

} // namespace bench
