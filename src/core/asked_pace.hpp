// SPDX-License-Identifier: MIT
/// \file
/// Duration or speed of a stroke: its own comes first, then the default.
#pragma once

#include <optional>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// A duration, or else a speed, for every stroke; and a speed for strokes that give neither.
struct asked_pace {
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {};
    std::optional<double> usual_speed_mm_s = {};
};

/// Sets the duration of a stroke.
/// \throws error as trajectory::with_duration() and with_speed() do.
inline void set_pace(stroke& s, const asked_pace& p)
{
    const std::optional<double> speed = p.speed_mm_s || !s.usual_pace ? p.speed_mm_s : p.usual_speed_mm_s;
    if (p.duration_s)
        s.motion = s.motion.with_duration(*p.duration_s);
    else if (speed)
        s.motion = s.motion.with_speed(*speed);
}

} // namespace tactor::detail
