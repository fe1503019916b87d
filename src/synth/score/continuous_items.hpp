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
    /// Upper bounds of peaks(), linear, by tactor: the greatest intensity at the gain of each. Of a plan that
    /// says nothing of its intensity, the peaks themselves.
    std::vector<double> bounds(std::size_t number);
    /// Greatest level of each tactor, linear; see continuous_peaks(). What is harmless in a stroke that no
    /// other one overlaps is not looked at.
    /// \throws error (bad_input) for plans that cannot be rendered.
    std::vector<double> peaks(std::size_t number);

    /// The amplitudes behind the peaks that were asked for last, or else behind the bounds, by plan and
    /// tactor: more must not come. Empty for plans that are not continuous.
    std::vector<std::vector<double>> promised();

private:
    const std::vector<double>& most(std::size_t number);
    const std::vector<double>& looked_at(std::size_t number);
    std::vector<double> at_levels(std::size_t number, std::vector<double> amplitudes) const;

    const score::impl& score_;
    double harmless_;
    std::vector<bool> overlaps_; ///< by item
    std::map<std::size_t, std::vector<double>> most_;
    std::map<std::size_t, std::vector<double>> looked_at_;
};

} // namespace tactor::synth
