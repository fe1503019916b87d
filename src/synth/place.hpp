// SPDX-License-Identifier: MIT
/// \file
/// From a plan to items.
#pragma once

#include "synth/score.hpp"

namespace tactor::synth {

/// Appends the items of plan number `plan`, which starts at frame `start`; bursts that overlap on one tactor
/// are joined, those that only touch are not. Of the options rate, phase and ramp count. Returns the frame at
/// which the plan ends. \throws error (bad_input) for a plan with times or amplitudes that are not finite, or
/// with tactors
///         that are not in the array.
std::uint64_t place_plan(const plan& p, std::uint32_t plan, std::uint64_t start, std::size_t tactors,
                         const render_options& o, item_list& out);

} // namespace tactor::synth
