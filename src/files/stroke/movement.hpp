// SPDX-License-Identifier: MIT
// How a stroke of a TOML file moves along its path: easing, profiles, pauses.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

/// Keys of their own; speed_mm_s and intensity may be lists, too.
inline constexpr std::array<std::string_view, 2> movement_keys{"easing", "pauses"};

/// What the file says of its pace; numbers and lists.
struct told_pace {
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {}; ///< the one speed
    double intensity = 1.0;                ///< the one intensity
    movement moves = {};                   ///< easing, lists and pauses
    std::string_view key = {};             ///< the first key that makes it uneven; empty: none

    /// Seconds for a way, if the file says.
    std::optional<double> time_for(double length_mm) const
    {
        return speed_mm_s ? length_mm / *speed_mm_s : duration_s;
    }
};

/// \throws error with file, line and column, as all here.
told_pace read_pace(const toml_table& t);

/// A stroke along a path as told; `own_s` is the time of what has one and is told none.
trajectory along_as_told(const toml_table& t, std::string_view kind, const path& way, const told_pace& told,
                         std::optional<double> own_s);

/// The mean speed that a stroke keeps when it is fitted; none where its time was told.
std::optional<double> kept_speed(const told_pace& told, double length_mm);

} // namespace tactor::detail
