// SPDX-License-Identifier: MIT
/// \file
/// What a user asks for, before any file is read.
#pragma once

#include <string>
#include <vector>

#include "options/wishes.hpp"

namespace tactor::session {

using options::stream_options;

/// Strokes, and options of strokes, plans, sound and the device.
struct settings : options::wishes {
    std::vector<std::string> strokes = {}; ///< STROKE arguments
};

} // namespace tactor::session
