// SPDX-License-Identifier: MIT
/// \file
/// Import and export: the conversion of files to strokes and of strokes to files. It runs on planner threads.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "net/rpc.hpp"
#include "server/request.hpp"

namespace tactor::server {

struct service_options;

/// Returns the names of the files that `export` makes.
std::vector<std::string_view> export_names();

/// Returns the result of `import` as JSON on one line. Does not open files.
/// \throws fault_error.
std::string import_strokes(const planning& with, const layout& faces, const net::json& params);

/// Returns the result of `export` as JSON on one line.
/// \throws fault_error, and the exceptions of resolve_options() and `go_on`.
std::string export_strokes(const service_options& o, const layout& faces, const net::json& params,
                           const go_on_check& go_on);

/// Returns a file name for a text. The name has 1 to 100 bytes: letters, digits, blanks, - and _. It does not
/// begin with -, and has no blank at either end. Other characters become _. An empty name becomes "stroke".
/// Non-ASCII characters count as letters; if has_controls() finds any of its kind, they all become _.
/// Precondition: `name` is valid UTF-8.
std::string make_file_name(std::string_view name);

} // namespace tactor::server
