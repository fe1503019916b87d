// SPDX-License-Identifier: MIT
/// \file
/// Rendered samples, reduced to what a page can show.
#pragma once

#include <cstdint>
#include <vector>

#include <tactor/render.hpp>

namespace tactor::plot {

/// Least and largest sample in one stretch of time.
struct sample_range {
    float low = 0.0F;
    float high = 0.0F;
};

/// Samples of some channels in stretches of equal length.
struct waveform {
    double stretch_s = 0.0;
    std::vector<std::vector<sample_range>> by_channel = {}; ///< in the order asked for
    std::vector<float> peaks = {};                          ///< largest magnitude of each
};

/// Renders a score into `stretches` stretches (fewer where a stretch would be shorter than one frame).
/// \throws error (bad_input) where there are more than 2e10 samples.
waveform look_at(const score& s, const std::vector<unsigned>& channels, std::size_t stretches);

} // namespace tactor::plot
