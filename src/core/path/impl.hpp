// SPDX-License-Identifier: MIT
// What is inside a path.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/arc_length.hpp"
#include "core/path/outline.hpp"

namespace tactor {
inline namespace v0 {

struct path::impl {
    struct measured_curve {
        std::size_t segment;
        detail::shape form;
        detail::arc_length measure;
    };

    std::vector<point> vertices;
    std::vector<double> s; ///< arc length at each vertex; ascending
    std::vector<measured_curve> curves;

    /// The curve of a segment; null where it is straight.
    const measured_curve* curve_of(std::size_t segment) const noexcept;
};

} // namespace v0
} // namespace tactor

namespace tactor::detail {

/// Measures an outline. What `what` gives stands for it in messages.
/// \throws error (bad_input) for coordinates that are not finite or beyond max_mm.
path make_path(outline o, const std::function<std::string()>& what);

} // namespace tactor::detail
