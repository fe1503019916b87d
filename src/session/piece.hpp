// SPDX-License-Identifier: MIT
/// \file
/// Conversion of sources and options to strokes, plans and a score, for the tool, the service and Python.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/tactor.hpp>

#include "files/plan/plan_json.hpp"
#include "options/option.hpp"

namespace tactor::session {

using files::piece;

/// Returns the names of sources of strokes: "stroke" (a preset or a shape), "path" (SVG path data), "points",
/// and each format of stroke files.
const std::vector<std::string_view>& source_names();

/// Reads strokes from the text of a source, except points. `named` stands for the text in errors.
/// \throws error (bad_input).
std::vector<stroke> read_strokes(std::string_view kind, const std::string& text, const std::string& named,
                                 const options::option_values& o);

/// Fits the strokes that request it, and all together if the options do; then sets their paces.
/// \throws error (bad_input).
void place_strokes(piece& p, const layout& faces, const options::option_values& o);

/// Plans stroke i of a piece, which has the plans of earlier strokes.
/// \throws error (bad_input).
void plan_stroke(piece& p, std::size_t i, const array& a, const layout& faces,
                 const options::option_values& o);

/// Returns a text, with marks, on how much weaker than requested a score of these strokes is and where they
/// meet; empty if it is as strong as requested.
std::string weakening_text(const weakening& w, std::size_t strokes);

} // namespace tactor::session
