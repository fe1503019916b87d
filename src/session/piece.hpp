// SPDX-License-Identifier: MIT
/// \file
/// Makes strokes, plans and a score from a source, for the tool, the service, studies and Python.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tactor/tactor.hpp>

#include "files/plan/plan_json.hpp"
#include "files/stroke_format.hpp"
#include "options/option.hpp"

namespace tactor::session {

using files::piece;

/// Name of a preset or a shape.
struct stroke_name {
    std::string name = {};
};

/// SVG path data, in mm.
struct path_data {
    std::string data = {};
};

/// Text of a stroke file. The source refers to this text. The text must not name other files.
struct format_text {
    const detail::stroke_format* format = nullptr;
    std::string_view text = {};
};

/// Stroke file. The extension of its name gives the format, or else its content.
struct stroke_file {
    std::filesystem::path file = {};
};

/// WAV file with the samples of all channels, in place of strokes.
struct samples_file {
    std::filesystem::path file = {};
};

/// Origin of a piece: a name, a path, timed points, a text or file, strokes or plans that were read, or
/// samples.
using source = std::variant<stroke_name, path_data, std::vector<timed_point>, format_text, stroke_file,
                            std::vector<stroke>, piece, samples_file>;

/// Returns the names of sources that a client can send: "stroke" (a preset or a shape), "path", "points", and
/// each format of stroke files.
const std::vector<std::string_view>& source_names();

/// Returns the source with one of these names, except "points". The source refers to `text`.
source make_source(std::string_view name, const std::string& text);

/// Reads the strokes of a source; does not plan them. `named`: name of the source in errors. Blocks for a
/// file.
/// \throws error (bad_input).
std::vector<stroke> read_strokes(source from, const std::string& named, const options::option_values& o);

/// Returns a stroke along a path; without a duration it moves at `speed_mm_s`, or rests for `rest_s` if the
/// path is a single place.
/// \throws error (bad_input).
stroke path_stroke(const std::string& data, std::optional<double> duration_s, double speed_mm_s,
                   std::optional<double> rest_s = {});

/// Returns a stroke through points as a recorder delivers them, with warnings about oddities.
/// \throws error (bad_input).
stroke points_stroke(const std::string& name, std::span<const timed_point> points, double intensity_max);

/// Sets the actuator of a waveform's vibration. Does nothing for a vibration that defines its actuator.
void use_actuator(waveform& w, const std::optional<actuator_numbers>& a);

/// Returns true if the places of a stroke depend on the array.
bool has_fit(std::span<const stroke> strokes);

/// Fits each stroke that requests it, and sets the actuator of vibrations. If the options request a fit, fits
/// all strokes together. Then sets the pace of each stroke.
/// \throws error (bad_input).
void place_strokes(piece& p, const layout& faces, const options::option_values& o);

/// Returns a piece with its strokes read and placed. Does not read samples. Changes nothing in plans but the
/// actuators of vibrations.
/// \throws error (bad_input).
piece read_piece(source from, std::string name, const layout& faces, const options::option_values& o);

/// Plans stroke i of a piece, which must have the plans of all earlier strokes.
/// \throws error (bad_input).
void plan_stroke(piece& p, std::size_t i, const array& a, const layout& faces,
                 const options::option_values& o);

/// Function that is called with i before the work on stroke i, and with the number of strokes before the work
/// on all strokes together. May throw.
using before_stroke = std::function<void(std::size_t i)>;

/// Plans the strokes of a piece, unless it has plans.
/// \throws error (bad_input).
void plan_piece(piece& p, const array& a, const layout& faces, const options::option_values& o,
                const before_stroke& next = {});

/// Makes the score of a piece from its samples, its plans or its strokes. Plans strokes one by one. Moves
/// each plan into the score, including plans that the piece already has. \throws error.
score make_score(piece& p, const array& a, const layout& faces, const options::option_values& o,
                 const render_options& r, const before_stroke& next = {});

/// Makes the score of a piece that keeps its plans.
/// \throws error (bad_input).
score make_score(const piece& p, const array& a, const render_options& r, const before_stroke& next = {});

/// Makes the score of a plan that plays `rounds` times, `round_s` apart.
/// \throws error (bad_input).
score make_score(const plan& p, const array& a, const render_options& r, std::uint64_t rounds,
                 double round_s);

/// A plan with the sound that it was made for.
struct sounding_plan {
    placed_plan placed;
    render_options sound;
};

/// Score of several plans, with their common options and their levels.
struct joined_score {
    score samples;
    render_options sound;            ///< options common to all plans, with the level of the loudest
    std::vector<double> levels = {}; ///< levels of the plans: dBFS, or dB above thresholds
};

/// Makes a score of plans. Each plan keeps its level.
/// \throws error (bad_input) if other options of their sounds differ.
joined_score join_plans(const array& a, std::vector<sounding_plan> plans);

/// Returns the level, dBFS or dB above thresholds.
double level_db(const render_options& r) noexcept;

/// Sets the number of channels, if it is not set, to the number that the array and the marker need.
render_options set_default_channels(const array& a, render_options r);

/// Describes how much the score of these strokes was weakened, and which strokes overlap. Returns an empty
/// text if the score was not weakened. The text has marks such as {together=sum}.
std::string weakening_text(const weakening& w, std::size_t strokes);

} // namespace tactor::session
