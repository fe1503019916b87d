// SPDX-License-Identifier: MIT
/// \file
/// Tables that two files contain: an array file and the file that names it, or the configuration.
#pragma once

#include <optional>
#include <vector>

#include <tactor/setup.hpp>

namespace tactor::detail {

/// Default limits on time if no file has any, s: those of drive_limits, which this folder does not know.
inline constexpr double usual_drive_s = 5.0;
inline constexpr double usual_window_s = 10.0;

/// Returns the limits of both files: the lower power, the shorter drive and the longer window. If a file has
/// only one of the two times, its other one is the default.
std::optional<limit_settings> join_limits(const std::optional<limit_settings>& a,
                                          const std::optional<limit_settings>& b);

/// Adds a value of [defaults], which replaces an earlier one of its name.
void add_default(std::vector<written_value>& all, written_value v);

/// Adds [serve] of a later file. Its values replace earlier ones of their names; of two values for a key
/// max_..., the lower stays.
void join_serve(std::vector<written_value>& all, const std::vector<written_value>& later);

} // namespace tactor::detail
