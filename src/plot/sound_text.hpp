// SPDX-License-Identifier: MIT
/// \file
/// The vibration of a plan in words.
#pragma once

#include <string>

#include <tactor/plan.hpp>

namespace tactor::plot {

/// Returns the vibration, for captions and listings: "250 Hz" (a sine), "square of 60 to 120 Hz", "noise of
/// 60 to 400 Hz", "brush.wav along the path"; with ", AM of 30 Hz" if it is modulated.
std::string describe_sound(const plan& p);

/// Returns the phantom model, and its faces if they are not Delaunay's: "inverse-distance (faces
/// nearest)".
std::string describe_phantom(const plan& p);

} // namespace tactor::plot
