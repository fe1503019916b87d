// SPDX-License-Identifier: MIT
/// \file
/// The keys of files, as tactor.toml(5) and tactor-experiment(5) explain them; file_keys.py reads the pages.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tactor::cli {

/// Returns what the manual says of a key in each table that has it, and the keys of a table, "limits" or
/// "[limits]". Ignores the tables in `besides`. Empty: there is neither.
std::string describe_key(std::string_view word, std::span<const std::string_view> besides = {});

/// Returns the keys whose description mentions the word, such as "grid" for "pitch_mm". Empty: none.
std::string describe_mention(std::string_view word);

} // namespace tactor::cli
