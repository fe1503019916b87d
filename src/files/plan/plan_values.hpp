// SPDX-License-Identifier: MIT
/// \file
/// From the objects of tactor-plan/1 to values.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/phantom.hpp>
#include <tactor/tactor.hpp>

#include "files/plan/json_value.hpp"
#include "files/plan/plan_file.hpp"

namespace tactor::files {

burst read_burst(const json_value& f);
/// Reads a point of a continuous stroke.
burst read_sample(const json_value& f);
array read_array(const json_value& plan);
render_options read_render(const json_value& plan);
placed_plan read_plan(const json_value& f, const array& a, std::vector<burst> bursts, curve_samples samples,
                      recordings_kind recordings);
/// Reads the compensation without its plan, if the plan has one.
std::optional<compensated_plan> read_compensation(const json_value& plan);
/// Reads the path of a plan's bursts or samples, or the target of compensated ones, for pictures.
stroke read_stroke(const json_value& f, const plan& p, const std::optional<compensated_plan>& moved);

/// Writes a fitting as x' = a x + c y + e, y' = b x + d y + f, as in SVG.
nlohmann::ordered_json fit_json(const fitting& f);

/// Reads the fitting of the plan's stroke, if it was fitted. \throws error (bad_input).
std::optional<fitting> read_fitting(const json_value& plan);

/// Puts the sound into the member "stroke", which names no defaults.
void put_sound(nlohmann::ordered_json& stroke, const plan& p);
/// Writes the member "render.envelope".
nlohmann::ordered_json envelope_json(const burst_envelope& e);

/// Write and read "threshold_dbfs" of a tactor: a level, a list of [Hz, dBFS], or null.
nlohmann::ordered_json threshold_json(const tactor_spec& t);
void take_threshold(const json_value& t, tactor_spec& into);

/// Reads the sound from "stroke", and the WAV file that it names, or refuses it. \throws error (bad_input).
void take_sound(const json_value& stroke, plan& p, recordings_kind recordings);
/// Reads the envelope from "render".
burst_envelope read_envelope(const json_value& render);

} // namespace tactor::files
