// SPDX-License-Identifier: MIT
/// \file
/// From a plan to items.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "synth/score/score.hpp"

namespace tactor::synth {

/// Appends the items of bursts of plan number `plan`, which starts at frame `start`. Bursts that overlap on
/// one tactor are joined; bursts that only touch are not. `bursts` may be a part of the plan's bursts, from
/// number `first` on, if nothing sounds just before and after this part. Of the plan only the carrier counts,
/// of the options only rate, phase and ramp. Returns the frame at which the bursts end.
/// \throws error (bad_input) for times or amplitudes that are not finite, or for tactors that are not in the
///         array.
std::uint64_t place_bursts(std::span<const burst> bursts, std::size_t first, const plan& p,
                           std::uint32_t plan, std::uint64_t start, std::size_t tactors,
                           const render_options& o, item_list& out);

/// Appends the item of a continuous plan, and returns the frame at which the plan ends. Its bursts end at
/// frame `bursts_end`.
/// \throws error (bad_input) for a duration that cannot be rendered.
std::uint64_t place_end(const plan& p, std::uint32_t plan, std::uint64_t start, std::uint64_t bursts_end,
                        const render_options& o, item_list& out);

} // namespace tactor::synth
