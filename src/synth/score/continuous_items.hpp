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
    /// Both must outlive this object; the items are in order of start.
    continuous_items(const score::impl& s, const array& a);

    /// Whether all bounds are finite. If they are not, there is an error, and only peaks() finds which.
    bool have_bounds();
    /// Upper bounds of peaks(), linear, by tactor: the greatest intensity at the gain of each. For a plan
    /// whose intensity is not known to be a bound, the peaks themselves.
    std::vector<double> bounds(std::size_t number);
    /// Greatest level of each tactor, linear, over its control points. Harmless parts of a stroke are not
    /// looked at if no other stroke overlaps it.
    /// \throws error (bad_input) for plans that cannot be rendered.
    std::vector<double> peaks(std::size_t number);

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
