// SPDX-License-Identifier: MIT
/// \file
/// Contents of a path, the outline from which a path is made (such as SVG path data), and the meetings of a
/// movement with a line.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Longest stretch within same_place_mm of a line that counts as a touch. A longer stretch runs along the
/// line. For comparison: a circle with a radius of 16 mm stays within a nanometre of its tangent for 0.01 mm.
inline constexpr double shortest_run_mm = 0.1;

/// Returns the meetings of a movement with a line. The movement is given by nodes. Between two nodes the
/// distance from the line is monotone. N has
///   size()             number of nodes
///   signed_distance(i) signed distance of node i from the line, mm
///   progress(i)        arc length or time of node i
///   length(i, j)       length from node i to node j, mm
///   find_crossing(i)   meeting between nodes i and i + 1, which lie on different sides
template <class N>
std::vector<double> find_intersections(const N& nodes)
{
    const auto on_line = [&](std::size_t i) { return std::abs(nodes.signed_distance(i)) <= same_place_mm; };
    const auto crosses = [&](std::size_t i) {
        return (nodes.signed_distance(i) < 0.0) != (nodes.signed_distance(i + 1) < 0.0);
    };
    // Returns the single meeting for the nodes first ... last, which are all on the line.
    const auto touch = [&](std::size_t first, std::size_t last) {
        if (last > first && nodes.length(first, last) <= same_place_mm)
            return nodes.progress(first); // the movement rests here: its arrival counts
        std::size_t nearest = first;
        for (std::size_t i = first > 0 ? first - 1 : first; i <= last; ++i) {
            if (nodes.signed_distance(i) == 0.0)
                return nodes.progress(i);
            if (i + 1 < nodes.size() && nodes.signed_distance(i + 1) != 0.0 && crosses(i))
                return nodes.find_crossing(i);
            if (std::abs(nodes.signed_distance(i)) < std::abs(nodes.signed_distance(nearest)))
                nearest = i;
        }
        return nodes.progress(nearest);
    };
    std::vector<double> found;
    for (std::size_t i = 0; i < nodes.size();) {
        if (!on_line(i)) {
            if (i + 1 < nodes.size() && !on_line(i + 1) && crosses(i))
                found.push_back(nodes.find_crossing(i));
            ++i;
            continue;
        }
        std::size_t last = i;
        while (last + 1 < nodes.size() && on_line(last + 1))
            ++last;
        if (nodes.length(i, last) <= shortest_run_mm)
            found.push_back(touch(i, last));
        i = last + 1;
    }
    return found;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

struct path::impl {
    struct measured_curve {
        std::size_t segment;
        detail::shape form;
        detail::arc_length measure;
        std::shared_ptr<const detail::curve_places> places = {}; ///< null: compute each place when needed
    };

    std::vector<point> vertices;
    std::vector<double> s; ///< arc length at each vertex; ascending
    std::vector<measured_curve> curves;

    /// Returns the curve of a segment, or null if it is straight.
    const measured_curve* find_curve(std::size_t segment) const noexcept;
};

} // namespace v0
} // namespace tactor

namespace tactor::detail {

/// A path before its lengths are measured. Segment i goes from vertex i to vertex i + 1 and is straight
/// unless `curves` contains it. A million straight segments therefore need little memory.
struct outline {
    struct curve {
        std::size_t segment = 0;
        shape form;
    };

    std::vector<point> vertices;
    std::vector<curve> curves; ///< in ascending order of `segment`

    // Add a segment. Segments without length are skipped.
    void line(point to);
    void bezier(point c1, point c2, point to);
    void quadratic(point c, point to);
    void arc(const elliptic& a, point to);
};

outline apply_map(outline o, const affine& m);

/// Returns a coordinate that is not finite or is beyond max_mm, if there is one.
std::optional<double> find_bad_coordinate(const outline& o);

/// Returns the path of an outline with its lengths measured. `what` is its name in messages.
/// \throws error (bad_input) for coordinates that are not finite or beyond max_mm.
path make_path(outline o, std::string_view what);

/// Returns a copy of a path. Each curve that a target crosses in many steps of about `step_mm` has a table of
/// places (curve_places). Places on the copy differ from those on `p` by less than 1e-9 mm.
path with_places(const path& p, double step_mm);

/// Number of subpaths that SVG path data (https://www.w3.org/TR/SVG2/paths.html) may have. With `one`, a
/// second subpath is a fault.
enum class subpaths { one, any };

/// Returns the subpaths that draw something, in user units. Skips moves without a drawing command after them.
/// A number beyond `limit` is a fault.
/// \throws value_fault at the first place that is not path data.
std::vector<outline> parse_path_data(std::string_view data, double limit, subpaths wanted);

} // namespace tactor::detail
