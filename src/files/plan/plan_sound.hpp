// SPDX-License-Identifier: MIT
/// \file
/// What vibrates, and how bursts rise and fall, in the JSON of a plan. What is as it is by default is not
/// there.
#pragma once

#include <nlohmann/json.hpp>

#include <tactor/tactor.hpp>

#include "files/plan/plan_values.hpp"

namespace tactor::files {

/// Into the member "stroke".
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
