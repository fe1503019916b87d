// SPDX-License-Identifier: MIT
/// \file
/// The method `import`: texts of stroke files, presets and shapes become strokes. Runs off the thread of the
/// sockets.
#pragma once

#include <cstddef>
#include <string>

#include "server/stroke_source.hpp"

namespace tactor::server {

/// Checks the parameters as far as no text must be read. \throws fault_error.
void check_import(const net::json& params);

/// Returns the result as JSON on one line. Opens no file. \throws fault_error, also for a result above
/// `most_bytes`.
std::string import_strokes(const planning& with, const layout& faces, const net::json& params,
                           std::size_t most_bytes);

} // namespace tactor::server
