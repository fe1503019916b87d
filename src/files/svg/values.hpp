// SPDX-License-Identifier: MIT
// Values of SVG attributes. All throw value_fault.
#pragma once

#include <functional>
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

/// preserveAspectRatio: where the picture stands in its frame (0 left or top, 0.5 middle, 1 right or bottom).
struct svg_aspect {
    bool keep = true;
    bool slice = false;
    double x = 0.5;
    double y = 0.5;
};

double svg_number(std::string_view text);
/// Converts a number with its unit. \throws value_fault.
using svg_unit = std::function<double(double value, std::string_view unit, std::size_t index)>;
/// Numbers with blanks or commas between; with units where `unit` takes them.
std::vector<double> svg_numbers(std::string_view text, const svg_unit& unit = {});
svg_length parse_svg_length(std::string_view text);
svg_view_box parse_svg_view_box(std::string_view text);
svg_aspect parse_svg_aspect(std::string_view text);
/// Reads a two-dimensional transform in SVG's or CSS's syntax, in small letters. A px is a user unit, as in
/// browsers.
affine parse_svg_transform(std::string_view text, const svg_viewport& v);
/// Reads transform-origin in small letters; returns user units.
point parse_svg_origin(std::string_view text, const svg_viewport& v);

/// Maps a view box into a frame.
affine fit(const svg_view_box& box, point corner, double width, double height, const svg_aspect& a) noexcept;

} // namespace tactor::detail
