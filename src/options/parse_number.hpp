// SPDX-License-Identifier: MIT
/// \file
/// Numbers as the command line gives them.
#pragma once

#include <string>

#include "core/bounds.hpp"

namespace tactor::options {

/// A finite number within bounds. \throws error (bad_input) naming `what`, the text, the number to give where
/// the text has a unit, and the range (`range_text`, where what is sensible is less than what is taken).
double parse_number(const std::string& what, const std::string& text, detail::bounds b,
                    const std::string& unit, const std::string& range_text = {});
/// The same, and it is whole.
double parse_whole(const std::string& what, const std::string& text, detail::bounds b,
                   const std::string& unit);

/// Returns "did you mean -12? " for a number that is out of bounds without its minus sign, else nothing.
std::string sign_hint(detail::bounds b, double v);

} // namespace tactor::options
