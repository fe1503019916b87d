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

/// Returns the STROKE arguments, or the option that stands for them. \throws error unless there is one of
/// them.
std::vector<std::string> stroke_arguments(const settings& s);

/// Returns the preset that a STROKE argument names; nothing if it is a file. \throws error (bad_input) for a
/// name that is neither.
std::optional<stroke> find_preset(const std::string& argument);

/// Returns true for a STROKE argument that is a WAV file: samples of one's own.
bool names_samples(std::string_view argument);

/// Refuses such a file where strokes are planned. \throws error (bad_input).
void refuse_samples(const std::string& argument);

/// Returns a STROKE argument as people read it: - is standard input.
std::string shown_name(const std::string& argument);

/// Returns the name of the piece's stroke i as every command prints it: the STROKE argument, followed by the
/// stroke's own name where it has one; of a plan, the name of the stroke that was planned.
std::string name_stroke(const piece& p, std::size_t i, const environment& e);

/// Returns an error about the piece's stroke i, if it has that, with its file and its number among several.
error of_stroke(const error& x, const piece& p, std::size_t i);

/// Reads one of the stroke_arguments(). A plan comes with its plans; what is a stroke is not planned yet.
/// Samples of one's own are not read yet: their piece has no strokes.
/// `faces` is what --fit puts strokes on. \throws error.
piece open_piece(const settings& s, const environment& e, const layout& faces, const std::string& argument);

/// Reads and plans where only one STROKE is taken. \throws error, also for a stroke that does not begin in
/// the piece.
piece plan_one_piece(const settings& s, const environment& e);

/// Makes the score of a piece, with `render.rate` and channels settled. Takes the plans that the piece has;
/// plans of other strokes become a part of the score one by one. Reads samples of one's own. \throws error.
score plan_and_score(piece& p, const settings& s, const environment& e, const layout& faces,
                     const render_options& render);

/// Makes the score of a piece that keeps its plans. \throws error.
score make_score(const piece& p, const environment& e, const render_options& render);

} // namespace tactor::cli
