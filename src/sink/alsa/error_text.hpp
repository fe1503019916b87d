// SPDX-License-Identifier: MIT
/// \file
/// ALSA's error numbers as advice.
#pragma once

#include <string>
#include <vector>

#include <tactor/error.hpp>

#include "sink/alsa/devices/cards.hpp"

namespace tactor::pcm {

/// "text (detail)", or "text" without a detail.
std::string with_detail(const std::string& text, const std::string& detail);

/// What exists instead of the PCM that was asked for.
struct surroundings {
    std::vector<std::string> pcms = {}; ///< names that the configuration defines
    system_root root = "/";
    std::vector<std::string> route = {}; ///< types of the plugins that the name leads through
};

/// Why a PCM could not be opened (negative errno) and what to do. `detail`: libasound's own words.
error open_error(const std::string& name, int code, const std::string& detail, const surroundings& s = {});

/// The error of a call that should have worked.
error call_error(const std::string& name, const char* call, int code);

} // namespace tactor::pcm
