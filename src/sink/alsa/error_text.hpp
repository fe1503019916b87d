// SPDX-License-Identifier: MIT
/// \file
/// Explanations and hints for ALSA's error numbers.
#pragma once

#include <string>
#include <vector>

#include <tactor/error.hpp>

#include "sink/alsa/devices/cards.hpp"

namespace tactor::alsa {

/// Returns "text (detail)", or "text" without a detail.
std::string with_detail(const std::string& text, const std::string& detail);

/// The system around a PCM that cannot be opened.
struct surroundings {
    std::vector<std::string> pcms = {}; ///< names that the configuration defines
    system_root root = "/";
    std::vector<std::string> route = {}; ///< types of the plugins on the name's route
    bool bad_arguments = false;          ///< the name's definition does not take the text after its colon
};

/// Returns why a PCM could not be opened (negative errno) and what to do. `detail`: libasound's own words.
error open_error(const std::string& name, int code, const std::string& detail, const surroundings& s = {});

/// Returns the error of a call that should have succeeded.
error call_error(const std::string& name, const char* call, int code);

} // namespace tactor::alsa
