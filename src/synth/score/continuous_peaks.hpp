// SPDX-License-Identifier: MIT
/// \file
/// What a continuous stroke asks of each tactor at most.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "synth/score/score.hpp"

namespace tactor::synth {

/// Of a stroke that overlaps others, so many control points are looked at one by one: 70 minutes.
inline constexpr std::uint64_t most_overlapping_points = std::uint64_t{1} << 22;

/// Greatest amplitude that a continuous plan asks of each of so many tactors in any of its control points;
/// between them the amplitude is linear. If make_plan() made the plan with a model of the library, no tactor
/// gets more than the intensity, which is linear between the points of a trajectory. In such a plan, control
/// points are not looked at in two cases; every tactor then counts as driven with the intensity itself,
/// wherever the target is:
/// - where the intensity is `harmless` or less;
/// - beyond the first `most` control points.
/// In any other plan each control point is looked at.
/// \throws error (bad_input) where the plan drives a tactor that is not there, or gives an impossible
///         amplitude.
std::vector<double> continuous_peaks(const plan& p, std::size_t tactors, double harmless, std::uint64_t most);

/// The greatest intensity of a continuous plan, as an upper bound of the amplitudes that it asks for. None
/// where the intensity is not known to be a bound. May be infinite or no number.
std::optional<double> greatest_intensity(const plan& p);

} // namespace tactor::synth
