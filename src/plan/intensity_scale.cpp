// SPDX-License-Identifier: MIT
#include <cmath>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/plan.hpp>

#include "core/refused.hpp"

namespace tactor {
inline namespace v0 {

double intensity_scale::amplitude(double intensity) const
{
    // Nothing, and what is no intensity, is left to those who take it.
    if (!(intensity > 0.0))
        return intensity;
    if (level_db != 0.0) {
        if (!std::isfinite(level_db))
            throw detail::bad_field("level_db", fmt::format("{} is no level", level_db), "give decibels");
        return intensity_scale{kind, exponent, sl_db}.amplitude(intensity) * std::pow(10.0, level_db / 20.0);
    }
    if (kind == scale_kind::linear)
        return intensity;
    if (kind == scale_kind::stevens) {
        if (!(exponent >= 0.1 && exponent <= 3.0))
            throw detail::bad_field(
                "stevens_exponent", fmt::format("{} is not one", exponent),
                "give 0.1 to 3; 0.95 at 60 Hz and 0.6 at 250 Hz on the finger (Stevens 1968)");
        return std::pow(intensity, 1.0 / exponent);
    }
    if (!(sl_db > 0.0 && sl_db <= 100.0))
        throw error(error_kind::bad_input, "intensity_scale",
                    fmt::format("sl needs the sensation level of intensity 1, not {} dB", sl_db),
                    "give sl_db above 0 dB, such as 7")
            .with_field("scale");
    return std::pow(10.0, sl_db * (intensity - 1.0) / 20.0);
}

} // namespace v0
} // namespace tactor
