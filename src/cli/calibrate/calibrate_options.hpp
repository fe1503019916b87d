// SPDX-License-Identifier: MIT
/// \file
/// Options of `calibrate`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/input.hpp"
#include "cli/session/page_options.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/experiment/definition.hpp"
#include "study/masking/masking.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

struct calibrate_options {
    study::calibration_settings settings; ///< as far as the options say it
    std::string output;
    std::string log; ///< empty: beside the output
    std::optional<std::string> tactors;
    std::optional<std::string> simulate;
    std::optional<std::uint32_t> seed;
    std::vector<std::string> keypads; ///< input devices of the participant's
    page_options page;
    std::optional<study::page_words> words; ///< of the page; none: English
    std::string masker;                     ///< PCM of the masking noise; empty: none
    study::masking_options masking;
    std::string of_staircase; ///< an option from the command line that an adjustment does not have
    bool has_start = false;   ///< the command line gives the start level, which no ceiling may lower
    bool resume = false;
};

void add_calibrate_options(CLI::App& command, calibrate_options& into);

/// Output and log have names that go with each other. \throws error (bad_input).
void settle_names(calibrate_options& o);

/// Returns the settings for this array, within its limits. \throws error (bad_input).
study::calibration_settings settle_calibration(const calibrate_options& o, const settings& s,
                                               const environment& e);

/// Returns "tactor 3" or "tactors 3, 4".
std::string name_tactors(const std::vector<unsigned>& tactors);

/// Prints the highest level of each tactor, and warns where only full scale limits it.
void print_ceilings(const study::calibration_settings& c);

} // namespace tactor::cli
