// SPDX-License-Identifier: MIT
/// \file
/// Options with what was given: precedence, and options that exclude or need each other.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/setup.hpp>

#include "options/option.hpp"

namespace tactor::options {

/// Takes what the user gave; marks the row as given. What [defaults] say of the option or of its rival no
/// longer counts. \throws error (bad_input) for a rival that the user gave as well, and for a text that
/// cannot be read.
void give(wishes& w, const option& o, const value& v);

/// A value of [defaults], checked.
struct said_default {
    const option* row = nullptr;
    value said = {};
    source_place at = {};
};

/// Checks [defaults]. \throws error (bad_input) with the place in the file.
std::vector<said_default> read_defaults(const setup& says);

/// Fills rows that can be given at w.place, and that the user did not give, from [defaults]. What a file says
/// wins over what was said before it. \throws error (bad_input) with the place in the file.
void apply_defaults(wishes& w, const setup& says);

/// Settles options that depend on others, once all are given. \throws error (bad_input) for those that
/// nothing uses.
void settle(wishes& w);

/// \throws error (bad_input) where an option would plan `what` anew, which is planned already.
void refuse_planning(const wishes& w, const std::string& what);

/// An error about a value that [defaults] gave, with its place there; others as they are.
error at_default(const wishes& w, const error& e);

} // namespace tactor::options
