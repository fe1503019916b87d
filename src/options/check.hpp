// SPDX-License-Identifier: MIT
/// \file
/// From what a front end was given to a value of an option.
#pragma once

#include <string>

#include "options/option.hpp"

namespace tactor::options {

/// Returns the value of a text as people type it: "0.07", "s16", "true".
/// \throws error (bad_input) about the option, with its bounds or choices.
value read_text(const option& o, const std::string& text);

/// Returns what a typed value is to the option: a number stays within its bounds, a text is one of its
/// choices. \throws error (bad_input) as above.
value read_value(const option& o, const value& said);

/// Sets an option to what read_text() or read_value() returned. \throws error (bad_input), about the option,
/// for a text that cannot be read.
void put(wishes& w, const option& o, const value& v);

} // namespace tactor::options
