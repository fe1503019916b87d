// SPDX-License-Identifier: MIT
/// \file
/// Strokes of files, and files of strokes: the results of import and export. Planners make them.
#pragma once

#include <string>
#include <string_view>

#include "net/rpc.hpp"
#include "server/request.hpp"

namespace tactor::server {

struct service_options;

/// Returns the result of `import` as JSON on one line. Opens no file.
/// \throws fault_error.
std::string import_strokes(const planning& with, const layout& faces, const net::json& params);

/// Returns the result of `export` as JSON on one line.
/// \throws fault_error, and exceptions of resolve_options() and `go_on`.
std::string export_strokes(const service_options& o, const layout& faces, const net::json& params,
                           const go_on_check& go_on);

/// Makes a name for a file from valid UTF-8: 1 to 100 bytes of letters, digits, blanks, - and _. It does not
/// begin with -, and does not begin or end with a blank. Other characters become _; an empty name becomes
/// "stroke". Characters beyond ASCII are letters, except those that has_controls() finds.
std::string make_file_name(std::string_view name);

} // namespace tactor::server
