// SPDX-License-Identifier: MIT
/// \file
/// The result of a calibration: an array file with its thresholds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/setup.hpp>

#include "files/setup_text.hpp"
#include "study/calibrate/calibration.hpp"

namespace tactor::study {

using detail::array_text;

/// Returns the tables [calibration] and [[calibration.tactor]].
std::string calibration_text(const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

/// Checks that a new file can be made there; leaves nothing behind.
/// \throws error: bad_input for a file that is there already or a folder that is not, runtime for what the
///         system refuses.
void check_new_output(const std::filesystem::path& file);

/// Checks that an array file is the result of a session. \throws error (bad_input) with the file's name.
void check_finished(const std::filesystem::path& file, const calibration_settings& s);

/// Writes it whole or not at all. Throws as above.
void write_new_output(const std::filesystem::path& file, const std::string& text);

/// Returns true if an earlier calibration is somebody else's, or only one of the two was simulated.
bool is_foreign(const calibration_origin& earlier, const calibration_settings& s);

/// Returns the array with the measured thresholds. Thresholds of the same participant at other carriers stay,
/// in lists by frequency; those of others go, at all tactors; a measured tactor loses any other threshold
/// that it had. A tactor that was not felt has none at this carrier.
array with_thresholds(array a, const std::optional<calibration_origin>& earlier,
                      const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

struct doubtful_threshold {
    unsigned tactor = 0;
    std::string why = {}; ///< a clause: "it is 20.4 dB above the median of the array's (-44.8 dBFS)"
};

/// Returns the array's thresholds at the session's carrier that are more than 12 dB above their median, and
/// those below which the check trials were still right after the second staircase.
std::vector<doubtful_threshold> find_doubtful(const array& a, const calibration_settings& s,
                                              const std::vector<tactor_threshold>& measured);

} // namespace tactor::study
