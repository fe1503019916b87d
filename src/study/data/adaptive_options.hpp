// SPDX-License-Identifier: MIT
/// \file
/// Options of an adaptive run.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tactor::study {

/// A track of each condition of an adaptive run.
struct adaptive_track {
    unsigned down = 0;     ///< positive answers in a row that move a staircase down; 0 for QUEST+
    bool mirrored = false; ///< true for a staircase that exchanges positive and negative answers, up and down
    std::size_t start = 0; ///< first value of a staircase

    friend bool operator==(const adaptive_track&, const adaptive_track&) = default;
};

/// Procedures of an adaptive run. They give values as indices into the run's values.
struct adaptive_options {
    /// Returns true if tracks may end before all their trials are played.
    bool may_end_early() const noexcept { return stop_sd || reversals; }

    std::vector<adaptive_track> tracks = {}; ///< tracks of each condition; empty if the run is not adaptive
    bool two_sided = true;                   ///< false if answers are right or wrong; see read_procedure()
    std::vector<std::size_t> steps = {};     ///< step sizes; every second reversal moves on to the next
    std::vector<double> slopes = {};         ///< slopes for QUEST+, as standard deviations of the normal
    std::vector<double> lapses = {};
    std::optional<double> stop_sd = {}; ///< a track of QUEST+ ends when the sd of its threshold is below this
    std::optional<unsigned> reversals = {}; ///< a staircase ends at this reversal

    friend bool operator==(const adaptive_options&, const adaptive_options&) = default;
};

} // namespace tactor::study
