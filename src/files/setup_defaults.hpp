// SPDX-License-Identifier: MIT
// [defaults] by the names of its keys, which are those of the tool's options.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include <tactor/setup.hpp>

namespace tactor::detail {

/// The keys of [defaults], in the order of the manual page.
std::span<const std::string_view> default_names();

/// Key to value as it may be typed, e.g. "phantom" to "barycentric", of what is said; the table reads the
/// same again from it.
std::map<std::string, std::string> default_texts(const default_settings& s);

} // namespace tactor::detail
