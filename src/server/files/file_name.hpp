// SPDX-License-Identifier: MIT
/// \file
/// Names of files that clients get: nothing that a file system, a shell or a person takes for something else.
#pragma once

#include <string>
#include <string_view>

namespace tactor::server {

/// Returns true for 1 to 100 bytes of letters, digits, blanks, - and _, of which the first is no - and
/// neither the first nor the last is a blank.
bool is_file_name(std::string_view name) noexcept;

/// Returns the name with _ for each character that is_file_name() does not allow; "stroke" for an empty one.
std::string make_file_name(std::string_view name);

} // namespace tactor::server
