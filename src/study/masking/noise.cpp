// SPDX-License-Identifier: MIT
#include "study/masking/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactor::study {
namespace {

// P. Kellet's sum of first-order filters: 3 dB per octave within a quarter of a dB from 10 Hz on at 48 kHz.
struct section {
    double pole;
    double gain;
};
constexpr std::array<section, 6> sections{{{0.99886, 0.0555179},
                                           {0.99332, 0.0750759},
                                           {0.96900, 0.1538520},
                                           {0.86650, 0.3104856},
                                           {0.55000, 0.5329522},
                                           {-0.7616, -0.0168980}}};
constexpr double direct = 0.5362;
constexpr double delayed = 0.115926;
constexpr int response_samples = 1 << 15; // until the slowest pole has nothing left

double amplitude(double dbfs)
{
    return std::pow(10.0, dbfs / 20.0);
}

} // namespace

double greatest_noise_dbfs(noise_color c) noexcept
{
    return c == noise_color::white ? -5.0 : -15.0;
}

noise::noise(noise_color c, double level_dbfs, std::string_view seed)
    : color_(c),
      gain_(amplitude(level_dbfs) * std::numbers::sqrt3), // what is uniform between -1 and 1 has 1 / sqrt 3
      r_(seed)
{
    if (c == noise_color::white)
        return;
    double energy = 0.0;
    for (int i = 0; i < response_samples; ++i) {
        const double y = shaped(i == 0 ? 1.0 : 0.0);
        energy += y * y;
    }
    gain_ /= std::sqrt(energy);
    poles_ = {};
    late_ = 0.0;
}

double noise::shaped(double white) noexcept
{
    double y = direct * white + late_;
    for (std::size_t i = 0; i < sections.size(); ++i) {
        poles_[i] = sections[i].pole * poles_[i] + sections[i].gain * white;
        y += poles_[i];
    }
    late_ = delayed * white;
    return y;
}

double noise::next() noexcept
{
    const double white = 2.0 * r_.unit() - 1.0;
    return std::clamp(gain_ * (color_ == noise_color::white ? white : shaped(white)), -1.0, 1.0);
}

} // namespace tactor::study
