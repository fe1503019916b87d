// SPDX-License-Identifier: MIT
// Tables that are not written as CSV with a header.
#pragma once

#include <string>
#include <string_view>

namespace tactor::detail {

/// Refuses line ends of CR alone, other separators than commas, and a header that is missing or in a comment,
/// with a message that says so. \throws error (bad_input) with `name`, line and column.
void refuse_other_form(std::string_view text, const std::string& name);

/// Returns true for nan in any case and for NA.
bool is_missing(std::string_view value) noexcept;

} // namespace tactor::detail
