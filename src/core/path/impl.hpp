// SPDX-License-Identifier: MIT
// Contents of a path: its vertices and curves, and the arc length of each piece with its inverse.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/curve_places.hpp"
#include "core/path/outline.hpp"
#include "core/path/shape.hpp"

namespace tactor::detail {

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

/// Measures an outline. `what` returns its name for messages.
/// \throws error (bad_input) for coordinates that are not finite or beyond max_mm.
path make_path(outline o, const std::function<std::string()>& what);

} // namespace tactor::detail
