// SPDX-License-Identifier: MIT
/// \file
/// Measured pieces, and references for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactor/tactor.hpp>

namespace bench {

/// Frames of a call: 10 ms.
inline constexpr std::size_t block = 480;

/// Makes a square array with `channels` tactors (9, 16, 64, ...), 20 mm apart.
tactor::array square(unsigned channels);

/// Makes strokes for a square array: one is park2016-1; several have different places, as far as there is
/// space, and different carriers.
std::vector<tactor::plan> strokes(const tactor::array& a, unsigned count, tactor::algorithm_kind algorithm);

/// Returns options with a level at which so many strokes may sound together.
tactor::render_options levels(unsigned count);

/// Makes so many strokes at once, over and over, on a square array.
std::vector<tactor::placed_plan> plans(unsigned channels, unsigned count, tactor::algorithm_kind algorithm);

/// Makes the score of these.
tactor::score piece(unsigned channels, unsigned count, tactor::algorithm_kind algorithm);

/// A first draft of a mixer: a call of std::sin for each sounding channel and sample.
class plain_loop {
public:
    plain_loop(const tactor::score& s, const std::vector<tactor::placed_plan>& plans, double level);
    void process(std::size_t frames, float* out);
    bool at_end() const { return position_ >= frames_; }

private:
    /// Amplitude from + slope * k at frame k.
    struct tone {
        std::uint64_t start;
        std::uint64_t end;
        std::uint64_t phase;
        unsigned channel;
        double from;
        double slope;
        double hz;
    };
    void add_bursts(const tactor::plan& p, std::uint64_t start, double level);
    void add_lines(const tactor::plan& p, std::uint64_t start, double level);

    std::vector<tone> tones_; ///< by start
    std::size_t first_ = 0;
    std::uint64_t longest_ = 0;
    std::uint64_t position_ = 0;
    std::uint64_t frames_;
    unsigned channels_;
    double rate_;
};

/// Returns the calling thread's CPU time: other programs are not the engine's cost.
double cpu_s() noexcept;

} // namespace bench
