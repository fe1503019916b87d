// SPDX-License-Identifier: MIT
/// \file
/// The library's errors speak of its fields, the tool's of its options.
#pragma once

#include <string>
#include <string_view>

#include <tactor/error.hpp>

#include "options/option.hpp"

namespace tactor::cli {

/// Returns "--level-dbfs" for the row level_dbfs.
std::string option_name(const options::option& o);

/// Returns a name without the dashes before it.
std::string_view bare_name(std::string_view name) noexcept;

/// Returns the text with its marks as options: "--timing fit".
std::string spelled(std::string_view marked);

/// The same error with what it names, and what it advises, as options: "--soa" for "soa_s", "--timing fit"
/// for "timing = fit". Doing so twice changes nothing.
error in_options(const error& e);

} // namespace tactor::cli
