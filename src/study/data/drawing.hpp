// SPDX-License-Identifier: MIT
/// \file
/// Drawings: places and paths that participants draw on the page, and the targets that they are compared
/// with.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/path.hpp>

namespace tactor::study {

struct drawn_point {
    double time_s = 0.0; ///< time since the first point, s
    point at = {};       ///< place in the coordinates of the array, mm

    friend bool operator==(const drawn_point&, const drawn_point&) = default;
};

/// Points in the order of their times.
using drawing = std::vector<drawn_point>;

/// Kind of drawing that a participant makes.
enum class drawing_kind {
    none,
    place, ///< one point
    path,
};

// Bounds of a drawing. A message from the page can hold most_drawn_points points.
inline constexpr std::size_t most_drawn_points = 600;
inline constexpr double farthest_drawn_mm = 10000.0; ///< greatest distance from the axes
inline constexpr double longest_drawn_s = 3600.0;

/// Writes the points as "TIME X Y;TIME X Y", to 1 ms and 0.01 mm.
std::string to_text(const drawing& d);

/// Reads a text in the form of to_text(). Returns nothing if it has no point or too many points, if a number
/// is missing or out of bounds, or if the times decrease.
std::optional<drawing> read_drawing(std::string_view text);

/// Removes every second point, but not the last point, until at most most_drawn_points remain.
drawing thin_out(drawing d);

/// Returns true if there is at least one point, all points are within the bounds above, and the times do not
/// decrease.
bool is_drawing(const drawing& d) noexcept;

/// Returns parts + 1 points at equal distances along a drawing. They are all the same if the drawing has no
/// length. \pre The drawing has a point.
std::vector<point> divide(const drawing& d, std::size_t parts);

double find_length_mm(const drawing& d) noexcept;

/// Path that an observer is predicted to feel from a stimulus.
struct predicted_path {
    std::string observer; ///< name of an observer of `compare`
    std::string motion;
    std::string method;
    drawing felt;
};

/// Answer to a trial.
struct trial_answer {
    // Not explicit: most answers are numbers.
    trial_answer(double n) : number(n) {}
    trial_answer(drawing d) : drawn(std::move(d)) {}

    double number = 0.0; ///< key, rating, place in a list or estimate; unused for a drawing
    drawing drawn = {};
};

} // namespace tactor::study
