// SPDX-License-Identifier: MIT
/// \file
/// From a source to strokes, plans and a score, for the tool, the service, studies and Python.
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

/// Text of a stroke file, which the source refers to. It must not name other files.
struct format_text {
    const detail::stroke_format* format = nullptr;
    std::string_view text = {};
};

/// Stroke file. Its name gives the format, or else its content.
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

/// Returns the source with one of these names, except points. It refers to the text.
source make_source(std::string_view name, const std::string& text);

/// Reads the strokes of a source, without plans. `named` stands for it in errors. Blocks for a file.
/// \throws error (bad_input).
std::vector<stroke> read_strokes(source from, const std::string& named, const options::option_values& o);

/// Returns a stroke along a path; without a duration it moves at `speed_mm_s`, or rests for `rest_s` if the
/// path is a single place.
/// \throws error (bad_input).
stroke path_stroke(const std::string& data, std::optional<double> duration_s, double speed_mm_s,
                   std::optional<double> rest_s = {});

/// Returns a stroke of points as a recorder delivers them, with warnings of oddities.
/// \throws error (bad_input).
stroke points_stroke(const std::string& name, std::span<const timed_point> points, double intensity_max);

/// Makes the vibration of a waveform, if it is one without numbers of its own, that of an actuator.
void use_actuator(waveform& w, const std::optional<actuator_numbers>& a);

/// Sets the actuator of vibrations. Fits the strokes that request it, and all together if the options do;
/// then sets their paces.
/// \throws error (bad_input).
void place_strokes(piece& p, const layout& faces, const options::option_values& o);

/// Returns a piece with its strokes read and placed. Plans remain as they are, and samples unread.
/// \throws error (bad_input).
piece read_piece(source from, std::string name, const layout& faces, const options::option_values& o);

/// Plans stroke i of a piece, which has the plans of earlier strokes.
/// \throws error (bad_input).
void plan_stroke(piece& p, std::size_t i, const array& a, const layout& faces,
                 const options::option_values& o);

/// Called with i before the work on stroke i, and with the number of strokes before the work on all of them.
/// May throw.
using before_stroke = std::function<void(std::size_t i)>;

/// Plans the strokes of a piece, unless it has plans.
/// \throws error (bad_input).
void plan_piece(piece& p, const array& a, const layout& faces, const options::option_values& o,
                const before_stroke& next = {});

/// Makes the score of a piece from its samples, its plans or its strokes. Plans strokes one by one and moves
/// each plan into the score. Moves plans that the piece has out of it. \throws error.
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

/// Score of plans, and what it was made with.
struct joined_score {
    score samples;
    render_options sound;            ///< common to all plans, at the level of the loudest
    std::vector<double> levels = {}; ///< of the plans: dBFS, or dB above thresholds
};

/// Makes a score of plans that each keep their level.
/// \throws error (bad_input) if other options of their sounds differ.
joined_score join_plans(const array& a, std::vector<sounding_plan> plans);

/// Returns the level, dBFS or dB above thresholds.
double level_db(const render_options& r) noexcept;

/// Sets the number of channels that the array and the marker need, if there is none.
render_options with_channels(const array& a, render_options r);

/// Returns a text, with marks, on how much weaker than requested a score of these strokes is and where they
/// meet; empty if it is as strong as requested.
std::string weakening_text(const weakening& w, std::size_t strokes);

} // namespace tactor::session
