// SPDX-License-Identifier: MIT
/// \file
/// The keys of files, with their descriptions from tactor.toml(5) and tactor-experiment(5). file_keys.py
/// reads them from these pages.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactor::cli {

/// Returns the manual's description of a key, for each table that has this key, except the tables in
/// `besides`. The name may begin with the table's name: "limits.power_dbfs". If `word` is the name of a table
/// ("limits", "[limits]" or "sync.codes"), also returns its keys. Returns "" if there is no such key or
/// table.
std::string describe_key(std::string_view word, std::span<const std::string_view> besides = {});

/// Returns descriptions of the keys whose description mentions the word, such as "grid" for "pitch_mm". For
/// "grid.pitch_mm", considers only the key "grid". Returns "" if there are none.
std::string describe_related_keys(std::string_view word);

/// Returns the names of all keys that are no options, each with and without the names of its tables.
std::vector<std::string> list_key_names();

} // namespace tactor::cli
