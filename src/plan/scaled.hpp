// SPDX-License-Identifier: MIT
/// \file
/// A plan at another level.
#pragma once

#include <tactor/plan.hpp>

namespace tactor::detail {

/// The plan with all its amplitudes and intensities times a factor, above 0. Samples of a curve are scaled
/// when they are read.
plan scaled(plan p, double factor);

} // namespace tactor::detail
