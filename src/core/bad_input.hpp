// SPDX-License-Identifier: MIT
/// \file
/// Errors of wrong values of fields.
#pragma once

#include <string_view>

#include <tactor/error.hpp>

namespace tactor::detail {

/// About a field, which is its subject.
[[nodiscard]] error bad_field(std::string_view field, std::string_view why, std::string_view hint = {});

} // namespace tactor::detail
