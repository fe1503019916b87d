// SPDX-License-Identifier: MIT
/// \file
/// Where to play taps so that they are felt as near to their targets as an array allows: a convex quadratic
/// programme.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <tactor/geometry.hpp>

#include "plan/faces/sides.hpp"

namespace tactor::detail {

/// Each tap has one constraint a side: four numbers of eight bytes for each.
inline constexpr std::size_t most_fit_constraints = 4'000'000;

/// The m with dot(out, m_i) <= reach for all sides that minimises sum |x(m) - targets|^2, where (I + K) x = m
/// (low_speed.hpp). By an interior-point method (Mehrotra 1992) whose steps are banded: O(n sides), some
/// twenty times. The sum is within 1e-16 n of the least in units of the array's size squared, by its duality
/// gap; within 1e-10 n where rounding ends the search before. `inside`: a point that keeps all sides. No
/// `give` may be 0.
/// \throws error (bad_input) for more constraints than can be kept, or links too strong for sixteen digits.
std::vector<point> fit_inside(std::span<const double> give, std::span<const point> targets,
                              const std::vector<beyond>& sides, point inside);

} // namespace tactor::detail
