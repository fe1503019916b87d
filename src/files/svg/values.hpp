// SPDX-License-Identifier: MIT
// Values of SVG attributes. All throw value_fault.
#pragma once

#include <string_view>
#include <vector>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Larger numbers are nonsense in any unit.
inline constexpr double max_user_units = 1e9;

inline constexpr double mm_per_px = 25.4 / 96.0;

/// Reference of relative lengths.
struct svg_viewport {
    double width = 100.0;  ///< 100 % across, user units
    double height = 100.0; ///< 100 % down
    double per_mm = 1.0;   ///< user units in a millimetre
};

/// Side to which the percentage of a length refers.
enum class svg_extent { width, height, diagonal };

struct svg_length {
    enum class unit { none, percent, mm };
    double value = 0.0;
    unit in = unit::none;

    double user_units(const svg_viewport& v, svg_extent e) const noexcept;
};

struct svg_view_box {
    point corner;
    double width = 0.0;
    double height = 0.0;
};

double svg_number(std::string_view text);
/// Reads numbers with blanks or commas between. Skips `unit` behind each.
std::vector<double> svg_numbers(std::string_view text, std::string_view unit = {});
svg_length parse_svg_length(std::string_view text);
svg_view_box parse_svg_view_box(std::string_view text);
/// Reads a list of transforms in small letters, also with the deg and px of a style. A px is a user unit, as
/// in browsers.
affine parse_svg_transform(std::string_view text);

} // namespace tactor::detail
