// SPDX-License-Identifier: MIT
/// \file
/// Values that a run varies: an option of its methods or a parameter of its strokes. Each value makes a
/// method of its own, so that all stimuli are planned and checked before the session.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {

/// Number of values of a run, at most.
inline constexpr std::size_t most_values = 401;

/// A number that a run may vary.
struct varied {
    detail::bounds allowed;
    bool on_db_axis = false; ///< a level in dB
};

/// Returns an option with a number that a method may have, or a parameter of a stroke; nothing for others.
std::optional<varied> find_varied(std::string_view name);

/// Adds the methods that the run plays in place of its own, one for each value, to `more`, whose first will
/// be number `from` of the definition. \throws error (bad_input): an option refuses a value.
void make_variants(const detail::toml_table& t, run_definition& r,
                   const std::vector<method_definition>& methods, std::vector<method_definition>& more);

/// Returns the stroke with the value of a method's stroke parameter, if it has one.
/// \throws error (bad_input): a length for a stroke that has none, a place beyond the limits.
stroke vary_stroke(stroke s, const method_definition& m);

} // namespace tactor::study
