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

/// Returns the result of `import` as JSON on one line. Opens no file. \throws fault_error.
std::string import_strokes(const planning& with, const layout& faces, const net::json& params);

/// Returns the result of `export` as JSON on one line. \throws fault_error, and what settle_options() and
/// `go_on` throw.
std::string export_strokes(const service_options& o, const layout& faces, const net::json& params,
                           const go_on_check& go_on);

/// Returns a word as a shell reads it.
std::string quote_word(std::string_view word);

/// Returns a name for a file: 1 to 100 bytes of letters, digits, blanks, - and _, of which the first is no -
/// and neither the first nor the last is a blank. Other characters become _; "stroke" stands for an empty
/// name. Characters beyond ASCII are letters, but for those that has_controls() finds. `name` is valid UTF-8.
std::string make_file_name(std::string_view name);

} // namespace tactor::server
