// SPDX-License-Identifier: MIT
/// \file
/// Warnings on standard error.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

namespace tactor::cli {

/// Prints warnings. Of those that differ only in numbers and quoted names it prints the first, and how many
/// more there are.
void say_warnings(std::span<const std::string> warnings);

/// Returns the warnings of all plans, in order.
std::vector<std::string> collect_warnings(std::span<const placed_plan> plans);

} // namespace tactor::cli
