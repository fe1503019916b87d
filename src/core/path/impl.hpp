// SPDX-License-Identifier: MIT
/// \file
/// Contents of a path: its vertices and curves, and the arc length of each piece with its inverse.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/curve_places.hpp"
#include "core/path/outline.hpp"
#include "core/path/shape.hpp"

namespace tactor::detail {

/// Longest touch. A longer stretch within same_place_mm of the line runs along the line. A circle of 16 mm
/// stays within a nanometre of its tangent for 0.01 mm.
inline constexpr double shortest_run_mm = 0.1;

/// Returns the meetings with a line of a movement that is given as nodes. Between two nodes the distance from
/// the line is monotone. N has
///   size()       number of nodes
///   off(i)       signed distance of node i from the line, mm
///   when(i)      arc length or time of node i
///   length(i, j) length from node i to node j, mm
///   root(i)      meeting between nodes i and i + 1, which lie on different sides
template <class N>
std::vector<double> find_meetings(const N& nodes)
{
    const auto on_line = [&](std::size_t i) { return std::abs(nodes.off(i)) <= same_place_mm; };
    const auto crosses = [&](std::size_t i) { return (nodes.off(i) < 0.0) != (nodes.off(i + 1) < 0.0); };
    // Returns the single meeting of the nodes first ... last, which all lie on the line.
    const auto touch = [&](std::size_t first, std::size_t last) {
        if (last > first && nodes.length(first, last) <= same_place_mm)
            return nodes.when(first); // a rest: the time of arrival
        std::size_t nearest = first;
        for (std::size_t i = first > 0 ? first - 1 : first; i <= last; ++i) {
            if (nodes.off(i) == 0.0)
                return nodes.when(i);
            if (i + 1 < nodes.size() && nodes.off(i + 1) != 0.0 && crosses(i))
                return nodes.root(i);
            if (std::abs(nodes.off(i)) < std::abs(nodes.off(nearest)))
                nearest = i;
        }
        return nodes.when(nearest);
    };
    std::vector<double> found;
    for (std::size_t i = 0; i < nodes.size();) {
        if (!on_line(i)) {
            if (i + 1 < nodes.size() && !on_line(i + 1) && crosses(i))
                found.push_back(nodes.root(i));
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

/// A table of (parameter, arc length). It is so fine that Gauss quadrature from one entry towards the next is
/// accurate to about a nanometre, even at cusps.
class arc_length {
public:
    explicit arc_length(const shape& c);

    double total() const noexcept { return s_.back(); }
    /// Returns the arc length at a parameter from 0 to 1. `c` is the shape from which the table was made.
    double at(const shape& c, double t) const noexcept;
    /// Returns the parameter at an arc length, clamped to 0 ... 1.
    double parameter(const shape& c, double s_mm) const noexcept;

private:
    bool even_; ///< the parameter is proportional to the length
    std::vector<double> t_;
    std::vector<double> s_;
    std::vector<double> speed_; ///< speed at each entry; empty if the parameter is proportional to the length
};

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

struct path::impl {
    struct measured_curve {
        std::size_t segment;
        detail::shape form;
        detail::arc_length measure;
        std::shared_ptr<const detail::curve_places> places = {}; ///< null: each is computed
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

/// Measures an outline. `what` is its name in messages.
/// \throws error (bad_input) for coordinates that are not finite or beyond max_mm.
path make_path(outline o, std::string_view what);

} // namespace tactor::detail
