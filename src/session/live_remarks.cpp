// SPDX-License-Identifier: MIT
#include "session/live_remarks.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"

namespace tactor::session {

std::string intensity_limit_text(double intensity, double intensity_max)
{
    return fmt::format("an intensity of {} plays as {}: the requested level is the ceiling",
                       plain_number(intensity), plain_number(intensity_max));
}

std::vector<std::string> live_remarks::take(const live_stroke& stroke, point p, double intensity)
{
    std::vector<std::string> remarks;
    const live_counts counts = stroke.counts();
    if (counts.held != 0 && !std::exchange(held_, true))
        remarks.push_back(intensity_limit_text(intensity * intensity_max_, intensity_max_));
    if (counts.outside != 0 && !std::exchange(outside_, true))
        remarks.push_back(fmt::format("the place ({}, {}) mm is outside the array and moves to its edge",
                                      plain_number(p.x_mm), plain_number(p.y_mm)));
    return remarks;
}

} // namespace tactor::session
