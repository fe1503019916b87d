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

namespace tactor::files {

burst read_burst(const json_value& f);
/// A point of a continuous stroke.
burst read_sample(const json_value& f);
array read_array(const json_value& plan);
render_options read_render(const json_value& plan);
placed_plan read_plan(const json_value& f, const array& a, std::vector<burst> bursts, curve_samples samples);
/// What --compensate did, without the plan; none where it was not asked for.
std::optional<compensated_plan> read_compensation(const json_value& plan);
/// The way of a plan's bursts or samples, or of what moved ones are to be felt as, for pictures.
stroke read_stroke(const json_value& f, const plan& p, const std::optional<compensated_plan>& moved);

/// x' = a x + c y + e, y' = b x + d y + f, as in SVG.
nlohmann::ordered_json fit_json(const fitting& f);

/// None where the plan's stroke was not fitted. \throws error (bad_input).
std::optional<fitting> read_fitting(const json_value& plan);

/// Sound and envelope in the JSON of a plan, which names no defaults. Puts them into the member "stroke".
void put_sound(nlohmann::ordered_json& stroke, const plan& p);
/// The member "render.envelope".
nlohmann::ordered_json envelope_json(const burst_envelope& e);

/// "threshold_dbfs" of a tactor: a level, a list of [Hz, dBFS], or null.
nlohmann::ordered_json threshold_json(const tactor_spec& t);
void take_threshold(const json_value& t, tactor_spec& into);

/// Back from "stroke". Reads the WAV file that it names. \throws error (bad_input).
void take_sound(const json_value& stroke, plan& p);
/// Back from "render".
burst_envelope read_envelope(const json_value& render);

} // namespace tactor::files
