// SPDX-License-Identifier: MIT
/// \file
/// Multidimensional scaling: represents items by points. The distances between points approximate the
/// differences that people felt between items.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tactor::study {

/// Items in a plane.
struct scaled_items {
    /// Place of each item, relative to the centre of all items.
    std::vector<std::array<double, 2>> places = {};
    double stress = 0.0; ///< Kruskal's stress-1; 0 if the distances in the plane equal the differences
};

/// Places two or more items in two dimensions by classical scaling (Torgerson 1952; Gower 1966). The first
/// dimension has the largest eigenvalue. In each dimension, the item farthest from 0 has a positive
/// coordinate. If an eigenvalue is below 0, all coordinates in this dimension are 0. `differences`: a
/// symmetric matrix with zeros on the diagonal.
scaled_items scale_items(const std::vector<std::vector<double>>& differences);

} // namespace tactor::study
