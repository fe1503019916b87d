// SPDX-License-Identifier: MIT
/// \file
/// Multidimensional scaling: items as points whose distances are like the differences that people felt.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tactor::study {

/// Items in a plane.
struct scaled_items {
    std::vector<std::array<double, 2>> places = {}; ///< by item, about their centre
    double stress = 0.0; ///< Kruskal's stress-1 of the distances in the plane; 0: they equal the differences
};

/// Places items by classical scaling (Torgerson 1952; Gower 1966) in two dimensions, the one with the larger
/// eigenvalue first. In each the item farthest from 0 is on the positive side. An eigenvalue below 0 gives a
/// dimension of 0. `differences`: a symmetric matrix with 0 in its diagonal, of two items or more.
scaled_items scale_items(const std::vector<std::vector<double>>& differences);

} // namespace tactor::study
