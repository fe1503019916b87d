// SPDX-License-Identifier: MIT
/// \file
/// Options of the user and of [defaults]: which wins, which exclude and which need each other.
#pragma once

#include <string>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/setup.hpp>

#include "options/option.hpp"

namespace tactor::options {

/// Sets an option that the user wrote. Values of [defaults] for it and for its rival no longer count.
/// \throws error (bad_input) if the user set its rival as well, and for a text that cannot be read.
void give(option_values& w, const option& o, const value& v);

/// A value of [defaults], checked.
struct default_value {
    const option* row = nullptr;
    value content = {};
    source_place at = {};
};

/// Checks [defaults].
/// \throws error (bad_input) with the place in the file.
std::vector<default_value> read_defaults(const setup& says);

/// Sets options that the front end (w.place) has and the user did not set, from [defaults]. They win over
/// earlier ones.
/// \throws error (bad_input) with the place in the file.
/// \throws error (bad_input) with the place in the file.
void apply_defaults(option_values& w, const setup& says);

/// Resolves options that depend on others, once all are set.
/// \throws error (bad_input) for options that nothing uses.
void resolve(option_values& w);

/// Refuses options of planning for `what`, which is planned already.
/// \throws error (bad_input).
void refuse_planning(const option_values& w, const std::string& what);

/// Refuses options that apply to strokes but not to own samples.
/// \throws error (bad_input).
void refuse_for_samples(const option_values& w, const std::string& what);

/// Adds the place in [defaults] to an error about a value from there. Returns other errors unchanged.
error at_default(const option_values& w, const error& e);

} // namespace tactor::options
