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

/// A square array with `channels` tactors (9, 16, 64, ...), 20 mm apart.
tactor::array square(unsigned channels);

/// For a square array: one stroke is park2016-1; of several, each has its own place, as far as there is
/// space, and its own carrier.
std::vector<tactor::plan> strokes(const tactor::array& a, unsigned count, tactor::algorithm_kind algorithm);

/// Options with a level at which so many strokes may sound together.
tactor::render_options levels(unsigned count);

/// So many strokes at once, over and over, on a square array.
std::vector<tactor::placed_plan> plans(unsigned channels, unsigned count, tactor::algorithm_kind algorithm);

/// The score of these.
tactor::score piece(unsigned channels, unsigned count, tactor::algorithm_kind algorithm);

/// What one would write first: a call of std::sin for each sounding channel and sample.
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

/// The calling thread's own time: what others do with the processor is not the engine's cost.
double cpu_s() noexcept;

} // namespace bench
