// SPDX-License-Identifier: MIT
// Suggestions for mistyped names.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Returns a hint: "did you mean 'channel'?", or "known keys: a, b, c" if no known name is similar. `kind` is
/// the plural noun for the names.
std::string suggestion(std::string_view name, std::span<const std::string_view> known, std::string_view kind);

/// Returns an error about a key that is not in `known`. `title` names the table in the message, e.g.
/// "[output]".
error unknown_key(const source_place& at, std::string_view key, std::string_view title,
                  std::span<const std::string_view> known);

/// Returns "did you mean 'palm-3x3'? presets: a, b", or "presets: a, b" if no preset has a similar name. For
/// short lists.
std::string preset_hint(std::string_view name, const std::vector<std::string>& presets);

/// Returns "did you mean 'level_dbfs'? Use one of a, b", or "use one of a, b" if no known name is similar.
std::string choice_hint(std::string_view name, std::span<const std::string_view> known);

/// Returns the known name that is most similar to `name`, such as "channel" for "chanel" or "pitch_mm" for
/// "pitch". Returns "" if no name is similar.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

/// Returns a hint that suggests the name `near`: "did you mean 'channel'?". If `name` ends with another unit
/// than `near`, the hint says how the value must change: "'t_s' is in s, not ms: divide by 1000".
std::string similar_name_hint(std::string_view name, std::string_view near);

/// Returns 'name' in quotes, shortened and without control characters, so that it fits in a message.
std::string quoted(std::string_view name);

} // namespace tactor::detail
