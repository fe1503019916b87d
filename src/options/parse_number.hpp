// SPDX-License-Identifier: MIT
/// \file
/// Numbers as the command line gives them.
#pragma once

#include <string>
#include <string_view>

#include "core/bounds.hpp"

namespace tactor::options {

/// Returns the bounds in words: "0 to 10 s".
std::string range_text(detail::bounds b, std::string_view unit);

/// Returns a finite number within bounds. \throws error (bad_input) about `what`, with the text, the number
/// to give where the text has a unit, and the range, in words of its own unless empty.
double parse_number(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit,
                    std::string range = {});
/// Returns a whole number within bounds. \throws error (bad_input) likewise.
double parse_whole(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit);

/// Returns "did you mean -12? " for a number that is out of bounds without its minus sign, else nothing.
std::string sign_hint(detail::bounds b, double v);

} // namespace tactor::options
