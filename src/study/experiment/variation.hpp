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

/// Adds variants of the run's methods to `more`: one for each value, for the standard and for silence. The
/// run plays the variants instead of the methods. In the definition, `more` comes after `methods`.
/// \throws error (bad_input) if an option does not allow a value.
void make_variants(const detail::toml_table& t, run_definition& r,
                   const std::vector<method_definition>& methods, std::vector<method_definition>& more);

/// Applies the stroke parameter of a variant, if any. Moves, turns or scales all strokes together, about the
/// mean of all start and end points.
/// \throws error (bad_input) if length_mm is set but the first stroke does not move, if apart_mm is set but
///         the first two strokes do not start at different places, or if a position is out of range.
void vary_strokes(std::vector<stroke>& all, const method_definition& m);

} // namespace tactor::study
