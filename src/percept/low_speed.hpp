// SPDX-License-Identifier: MIT
/// \file
/// Chain of taps that the low-speed observer pulls together: (I + K) x = m, K the Laplacian whose link i has
/// the weight k_i = (sigma / (sigma_v (t_(i+1) - t_i)))^2.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// Returns 1 / k of each link: 0 if two taps begin together.
/// \throws error (bad_input) as felt_places() does.
std::vector<double> link_give(const low_speed_observer& o, std::span<const double> onsets_s);

/// Solves for x. O(n).
std::vector<point> pulled(std::span<const double> give, std::span<const point> alone);

/// Returns (I + K) x. No `give` may be 0.
std::vector<point> pushed(std::span<const double> give, std::span<const point> felt);

/// Returns the centre of energy of a burst's drives, multiplied by the gains of their tactors, if any;
/// nothing for a silent burst.
/// \throws error (bad_input) for a tactor that the array does not have.
std::optional<point> find_centre(const array& a, const burst& b, std::span<const double> gains = {});

} // namespace tactor::detail
