// SPDX-License-Identifier: MIT
/// \file
/// Noise that nobody hears the array through: the same for the same seed, on every machine.
#pragma once

#include <array>
#include <string_view>

#include "study/random/random.hpp"

namespace tactor::study {

enum class noise_color {
    white, ///< the same power in every Hz
    pink,  ///< the same power in every octave
};

/// The greatest level, dBFS, at which it is not cut: white noise is uniform, pink noise has peaks, which
/// above full scale (15 dB above this level, once in minutes) are cut there.
double greatest_noise_dbfs(noise_color c) noexcept;

/// Levels are roots of the mean square, in dB below that of a full-scale square.
class noise {
public:
    noise(noise_color c, double level_dbfs, std::string_view seed);

    /// The next sample, -1 to 1. Does not block or allocate.
    double next() noexcept;

private:
    double shaped(double white) noexcept;

    noise_color color_;
    double gain_;
    random_numbers r_;
    std::array<double, 6> poles_{};
    double late_ = 0.0;
};

} // namespace tactor::study
