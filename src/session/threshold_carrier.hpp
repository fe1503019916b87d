// SPDX-License-Identifier: MIT
/// \file
/// Warnings about plans at other carriers than the thresholds.
#pragma once

#include <span>
#include <string>

#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "session/environment.hpp"

namespace tactor::session {

/// Returns a sentence if a plan has another carrier than [calibration], to which a single threshold of the
/// array belongs; else nothing.
std::string other_carrier(const environment& e, std::span<const plan* const> plans);

/// Says this once about all plans, if levels are above thresholds.
void tell_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores);

} // namespace tactor::session
