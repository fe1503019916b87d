// SPDX-License-Identifier: MIT
/// \file
/// From a source and options to strokes, plans and a score, for the tool, the service and the Python package.
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

/// Reads strokes from a text of a kind: "stroke" (the name of a preset or a shape), "path" (SVG path data),
/// "toml", "csv" or "svg". `named` stands for the text in errors. \throws error (bad_input).
std::vector<stroke> read_strokes(std::string_view kind, const std::string& text, const std::string& named,
                                 const options::wishes& o);

/// Fits the strokes that ask for it and, where the options do, all of them together; then sets their paces.
/// \throws error (bad_input).
void place_strokes(piece& p, const layout& faces, const options::wishes& o);

/// Plans stroke i of a piece, which has plans of those before. \throws error (bad_input).
void plan_stroke(piece& p, std::size_t i, const array& a, const layout& faces, const options::wishes& o);

/// Returns how much weaker than asked for a score of so many strokes is, and where they meet, with marks;
/// empty: it is as strong as asked for.
std::string weakening_text(const weakening& w, std::size_t strokes);

} // namespace tactor::session
