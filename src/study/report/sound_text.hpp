// SPDX-License-Identifier: MIT
/// \file
/// What a plan's carrier is, and how it is shaped, in words.
#pragma once

#include <string>

#include "study/report/json_fact.hpp"

namespace tactor::study {

/// "a sine of 250 Hz, amplitude-modulated at ..."; of a plan (schema tactor-plan/1).
std::string carrier_of(const json_fact& plan);

/// The shape of its bursts but for the ramps' length: "raised-cosine ramps".
std::string envelope_of(const json_fact& plan);

/// Of actuators that take time to move, how long and what is done about it; empty where there are none.
std::string rise_of(const json_fact& plan);

} // namespace tactor::study
