// SPDX-License-Identifier: MIT
/// \file
/// Whether thresholds hold at the carriers that are played.
#pragma once

#include <span>
#include <string>

#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "session/environment.hpp"

namespace tactor::session {

/// Of an array whose [calibration] says at which carrier a threshold holds that stands alone: what is to be
/// said where a plan has another. Empty: nothing.
std::string other_carrier(const environment& e, std::span<const plan* const> plans);

/// Says it once of all that is played, where levels are above thresholds.
void tell_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores);

} // namespace tactor::session
