// SPDX-License-Identifier: MIT
/// \file
/// A run may vary an option of its methods or a parameter of its strokes. Each value becomes a separate
/// method, so that all stimuli are planned and checked before the session.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"
#include "study/data/definition.hpp"

namespace tactor::study {

/// Adds the methods that the run plays in place of its own to `more`: one for each value, for the standard
/// and for silence. In the definition `more` comes after `methods`. \throws error (bad_input) if an option
/// does not allow a value.
void make_variants(const detail::toml_table& t, run_definition& r,
                   const std::vector<method_definition>& methods, std::vector<method_definition>& more);

/// Changes strokes by the value of the method's stroke parameter, if it has one. They move, turn and grow
/// together, about the middle between all their ends.
/// \throws error (bad_input) if a stroke that does not move would get a length, if no two strokes start at
/// two
///         places that could get a distance, or if a position is out of range.
void vary_strokes(std::vector<stroke>& all, const method_definition& m);

} // namespace tactor::study
