// SPDX-License-Identifier: MIT
/// \file
/// The ramp with which a burst, or a continuous stroke, rises.
#pragma once

#include <tactor/plan.hpp>
#include <tactor/render.hpp>

namespace tactor::synth {

/// The ramp where the envelope does not give one.
double plain_ramp_s(double onset_s, double duration_s, const plan& p, const render_options& o) noexcept;

} // namespace tactor::synth
