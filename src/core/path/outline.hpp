// SPDX-License-Identifier: MIT
// A path before it is measured. Straight segments are vertices only, so a million of them need little memory.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Segments of a path. Segment i goes from vertex i to vertex i + 1. It is straight unless `curves` contains
/// it.
struct outline {
    struct curve {
        std::size_t segment = 0;
        shape form;
    };

    std::vector<point> vertices;
    std::vector<curve> curves; ///< by ascending segment

    // Add a segment. Skip segments without length.
    void line(point to);
    void bezier(point c1, point c2, point to);
    void quadratic(point c, point to);
    void arc(const elliptic& a, point to);
};

outline mapped(outline o, const affine& m);

/// Returns a coordinate that is not finite or beyond max_mm, if any.
std::optional<double> absurd_coordinate(const outline& o);

} // namespace tactor::detail
