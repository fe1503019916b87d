// SPDX-License-Identifier: MIT
/// \file
/// Rules for tables that occur in two files: in an array file, and in the configuration or in a file that
/// names the array file.
#pragma once

#include <optional>
#include <vector>

#include <tactor/setup.hpp>

namespace tactor::detail {

/// Limits on time that apply if no file has any, s. They are equal to those of drive_limits, whose header
/// this folder may not include.
inline constexpr double usual_drive_s = 5.0;
inline constexpr double usual_window_s = 10.0;

/// Returns limits that satisfy both files: the lower power, the shorter drive and the longer window. If a
/// file has only one of the two times, the other time of this file is the default.
std::optional<limit_settings> join_limits(const std::optional<limit_settings>& a,
                                          const std::optional<limit_settings>& b);

/// Adds a value of [defaults]. It replaces an earlier value with the same name.
void add_default(std::vector<written_value>& all, written_value v);

/// Adds [serve] of a later file. Its values replace earlier values with the same names. For a key max_...,
/// the lower value is kept.
void join_serve(std::vector<written_value>& all, const std::vector<written_value>& later);

} // namespace tactor::detail
