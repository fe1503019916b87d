// SPDX-License-Identifier: MIT
// What a user may have meant.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>

namespace tactor::detail {

/// A hint: "did you mean 'channel'?", or "known keys: a, b, c" where nothing is near. `kind` is the
/// plural of what the names are.
std::string suggestion(std::string_view name, std::span<const std::string_view> known, std::string_view kind);

/// An error about a key that is none of `known` in the table called `title`, e.g. "[output]".
error unknown_key(const source_place& at, std::string_view key, std::string_view title,
                  std::span<const std::string_view> known);

/// "did you mean 'palm-3x3'? presets: a, b", or "presets: a, b": for the few that there are.
std::string preset_hint(std::string_view name, const std::vector<std::string>& presets);

/// The one of `known` that `name` is a slip of, e.g. "chanel" of "channel" or "pitch" of "pitch_mm",
/// for a hint in an error; empty if none is near.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

/// 'name' in quotes, cut and cleaned of control characters so that it fits in a message.
std::string quoted(std::string_view name);

} // namespace tactor::detail
