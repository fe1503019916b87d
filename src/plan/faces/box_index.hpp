// SPDX-License-Identifier: MIT
/// \file
/// Boxes in the plane, found by place.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <tactor/path.hpp>

namespace tactor::detail {

struct box {
    point low;
    point high;
};

/// Returns the smallest box round some points (at least one).
box box_around(const std::vector<point>& points);

/// Immutable grid of square cells over boxes (at least one), about as many cells as boxes. An item is its
/// place in the vector.
class box_index {
public:
    explicit box_index(std::vector<box> boxes);

    /// Replaces `out` by the items whose boxes come within `margin_mm` of p, ascending.
    void near(point p, double margin_mm, std::vector<unsigned>& out) const;

    /// Returns the item with the least distance(item), of equals the first. `distance` may not be less than
    /// the distance to the item's box.
    unsigned nearest(point p, const std::function<double(unsigned)>& distance) const;

private:
    /// Cells from left to right and from low to high, the last included.
    struct range {
        std::size_t left;
        std::size_t right;
        std::size_t low;
        std::size_t high;
    };
    range cells(const box& b) const;

    std::vector<box> boxes_;
    box all_;
    double cell_mm_;
    std::size_t columns_;
    std::size_t rows_;
    std::vector<std::vector<unsigned>> items_; ///< by cell, row after row; each ascending
};

} // namespace tactor::detail
