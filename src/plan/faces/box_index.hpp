// SPDX-License-Identifier: MIT
/// \file
/// Boxes in the plane, found by place.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include <tactor/geometry.hpp>

namespace tactor::detail {

struct box {
    point low;
    point high;
};

/// The smallest box round some points (at least one).
box box_around(const std::vector<point>& points);

/// Immutable R-tree over boxes; an item is its place in the vector. Alone in its source file because
/// Boost.Geometry is slow to compile.
class box_index {
public:
    explicit box_index(const std::vector<box>& boxes);

    /// Replaces `out` by the items whose boxes come within `margin_mm` of p, ascending.
    void near(point p, double margin_mm, std::vector<unsigned>& out) const;

    /// The item with the least distance(item), of equals the first. `distance` may not be less than
    /// the distance to the item's box. The index must not be empty.
    unsigned nearest(point p, const std::function<double(unsigned)>& distance) const;

private:
    struct tree;
    std::shared_ptr<const tree> tree_;
};

} // namespace tactor::detail
