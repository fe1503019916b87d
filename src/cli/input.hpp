// SPDX-License-Identifier: MIT
/// \file
/// From STROKE arguments to strokes, plans and scores.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/settings.hpp"
#include "session/piece.hpp"

namespace tactor::cli {

using session::piece;

/// Returns true if the command line has a STROKE, a path or a shape.
bool gives_stroke(const settings& s);

/// Returns the STROKE arguments, or the option in place of them. \throws error if there are none, or both.
std::vector<std::string> stroke_arguments(const settings& s);

/// Returns the preset that a STROKE argument names; nothing if it is a file. \throws error (bad_input) for a
/// name that is neither.
std::optional<stroke> find_preset(const std::string& argument);

/// Returns true for a STROKE argument that is a WAV file, which has samples and no stroke.
bool names_samples(std::string_view argument);

/// Refuses a WAV file, for commands that plan strokes. \throws error (bad_input).
void refuse_samples(const std::string& argument);

/// Returns a STROKE argument as people read it: "standard input" for -, and escapes for control characters.
std::string shown_name(const std::string& argument);

/// Returns the name of stroke i of a piece, as every command prints it: the STROKE argument, then the
/// stroke's own name if it has one. For a plan, this is the name of the stroke that was planned.
std::string name_stroke(const piece& p, std::size_t i, const environment& e);

/// Adds the file to an error about stroke i of a piece, and the number of the stroke if there are several.
/// Returns the error as it is if the piece has no stroke i.
error of_stroke(const error& x, const piece& p, std::size_t i);

/// Reads one of the stroke_arguments() as session::read_piece() does. \throws error.
piece open_piece(const settings& s, const environment& e, const layout& faces, const std::string& argument);

/// Reads and plans the STROKE of a command that takes only one. \throws error, also for a stroke that does
/// not begin in the piece.
piece plan_one_piece(const settings& s, const environment& e);

/// Makes the score of a piece as session::make_score() does, with `render.rate` and channels settled. Its
/// errors name the stroke. \throws error.
score plan_and_score(piece& p, const settings& s, const environment& e, const layout& faces,
                     const render_options& render);

/// Makes the score of a piece that keeps its plans. Its errors name the stroke. \throws error.
score make_score(const piece& p, const environment& e, const render_options& render);

} // namespace tactor::cli
