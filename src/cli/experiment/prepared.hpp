// SPDX-License-Identifier: MIT
/// \file
/// An experiment on an array, for a participant: all that can be settled and checked before anybody sits
/// down.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/experiment/experiment_options.hpp"
#include "cli/input.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/sequence.hpp"
#include "study/experiment/stimuli.hpp"

namespace tactor::cli {

/// Between the program and its cards; empty: none.
struct sound_servers {
    std::string array = {};
    std::string masker = {};
};

struct prepared_experiment {
    study::experiment_definition definition;
    std::string participant;
    std::uint64_t seed = 0;
    environment where; ///< its array has thresholds where the level is a sensation level
    std::string pcm;   ///< "null" where nothing names one
    render_options render;
    bool assumed = false; ///< thresholds that nobody measured
    std::vector<study::run_sequence> runs;
    study::stimulus_set stimuli;
    std::vector<std::string> warnings;
    std::vector<std::string> calibration_doubts; ///< of the warnings, those about the thresholds' origin
};

/// The threshold that is taken where nobody measured one, and nobody feels anything.
inline constexpr double assumed_threshold_dbfs = -40.0;

/// \throws error (bad_input): the definition, array or configuration is wrong, a stimulus cannot be planned
///         or played; there are no thresholds and somebody is to feel it.
prepared_experiment prepare(const experiment_options& o, settings& s, option_list& options);

} // namespace tactor::cli
