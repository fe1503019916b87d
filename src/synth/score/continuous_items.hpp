// SPDX-License-Identifier: MIT
/// \file
/// The continuous strokes of a score, for the check of its peaks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "synth/score/score.hpp"

namespace tactor::synth {

class continuous_items {
public:
    /// Both must live as long; the items go by start.
    continuous_items(const score::impl& s, const array& a);

    /// Whether all bounds are finite; otherwise there is something to tell that only a look will find.
    bool have_bounds();
    /// Upper bounds of peaks(): the greatest intensity at the gain of each tactor. Of a plan that says
    /// nothing of its intensity, the peaks themselves.
    const std::vector<double>& bounds(std::size_t number);
    /// Greatest amplitude of each tactor; see continuous_peaks(). What is harmless is left out of a stroke
    /// that no other one overlaps.
    /// \throws error (bad_input) for plans that cannot be rendered.
    const std::vector<double>& peaks(std::size_t number);

private:
    std::vector<tactor_level> levels(std::uint32_t plan) const;

    const score::impl& score_;
    double harmless_;
    std::vector<bool> overlaps_; ///< by item
    std::map<std::size_t, std::vector<double>> bounds_;
    std::map<std::size_t, std::vector<double>> peaks_;
};

} // namespace tactor::synth
