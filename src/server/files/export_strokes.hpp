// SPDX-License-Identifier: MIT
/// \file
/// The method `export`: strokes become files, in memory. Runs off the thread of the sockets.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "server/files/tool_line.hpp"
#include "server/stroke_source.hpp"

namespace tactor::server {

/// Everything that an exported file depends on beside the request. What it refers to must outlive it.
struct exporting {
    const planning& with;
    const layout& faces;
    const tool_files& named; ///< in the tool's command line
    /// Returns the tactor-plan/1 text of a plan; throws std::bad_alloc beyond so many bytes.
    const std::function<std::string(const planned&, std::size_t most_bytes)>& plan_text;
    std::size_t most_bytes; ///< of the file
};

/// Checks the parameters as far as no text must be read. \throws fault_error.
void check_export(const planning& with, const net::json& params);

/// Returns the result as JSON on one line. \throws fault_error, and what `go_on` throws.
std::string export_strokes(const exporting& e, const net::json& params, const go_on_check& go_on);

} // namespace tactor::server
