// SPDX-License-Identifier: MIT
/// \file
/// Resolution of options from the user and from [defaults]: priorities, exclusions and dependencies.
#pragma once

#include <string>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/setup.hpp>

#include "options/option.hpp"

namespace tactor::options {

/// Sets an option to the user's value. Values from [defaults] for this option and for its rival are cleared.
/// \throws error (bad_input) if the user also set the rival, or if a text cannot be parsed.
void give(option_values& w, const option& o, const value& v);

/// A value of [defaults] that has been checked.
struct default_value {
    const option* row = nullptr;
    value content = {};
    source_place at = {};
};

/// Reads and checks [defaults].
/// \throws error (bad_input) with the place in the file.
std::vector<default_value> read_defaults(const setup& says);

/// Sets options to their values in [defaults]. Skips options that the front end (w.place) does not have, and
/// options that the user set. Replaces values from earlier calls.
/// \throws error (bad_input) with the place in the file.
void apply_defaults(option_values& w, const setup& says);

/// Resolves options that depend on other options. Call it when all options have been set.
/// \throws error (bad_input) for an option that has no effect.
void resolve(option_values& w);

/// Refuses options that affect planning, because `what` is already a plan.
/// \throws error (bad_input).
void refuse_planning_options(const option_values& w, const std::string& what);

/// Refuses options that apply to strokes, because `what` has samples of its own.
/// \throws error (bad_input).
void refuse_stroke_options(const option_values& w, const std::string& what);

/// Adds the place in [defaults] to an error if the wrong value comes from there. Returns other errors
/// unchanged.
error locate_default_error(const option_values& w, const error& e);

} // namespace tactor::options
