// SPDX-License-Identifier: MIT
/// \file
/// Functions that turn STROKE arguments into strokes, plans and scores.
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
bool has_stroke_argument(const settings& s);

/// Returns the STROKE arguments, or the option that replaces them.
/// \throws error if there is neither an argument nor such an option, or both.
std::vector<std::string> stroke_arguments(const settings& s);

/// Returns the preset that a STROKE argument names, or nothing if the argument is a file.
/// \throws error (bad_input) if the argument is neither.
std::optional<stroke> find_preset(const std::string& argument);

/// Returns true if a STROKE argument is a WAV file, which contains samples instead of a stroke.
bool is_wav_argument(std::string_view argument);

/// Refuses a WAV file. For commands that plan strokes. \throws error (bad_input).
void refuse_samples(const std::string& argument);

/// Returns a STROKE argument in the form for messages: "standard input" for -, and control characters
/// escaped.
std::string shown_name(const std::string& argument);

/// Returns the name of stroke i of a piece, in the form that every command prints: the STROKE argument, then
/// the stroke's own name if it has one. If the argument is a plan, the stroke is the one that was planned.
std::string format_stroke_name(const piece& p, std::size_t i, const environment& e);

/// Adds the file to an error about stroke i of a piece. If there are several strokes, also adds the number of
/// the stroke. Returns the error unchanged if the piece has no stroke i.
error add_stroke_to_error(const error& x, const piece& p, std::size_t i);

/// Reads a piece from one of the stroke_arguments(), as session::read_piece() does. \throws error.
piece open_piece(const settings& s, const environment& e, const layout& faces, const std::string& argument);

/// Reads and plans the STROKE of a command that accepts only one.
/// \throws error, also for a stroke that would start before the piece.
piece plan_one_piece(const settings& s, const environment& e);

/// Makes the score of a piece, as session::make_score() does. Precondition: `render.rate` and channels are
/// set. An error names the stroke. \throws error.
score plan_and_score(piece& p, const settings& s, const environment& e, const layout& faces,
                     const render_options& render);

/// Makes the score of a piece from its existing plans. An error names the stroke. \throws error.
score make_score(const piece& p, const environment& e, const render_options& render);

} // namespace tactor::cli
