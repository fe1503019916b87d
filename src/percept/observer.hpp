// SPDX-License-Identifier: MIT
/// \file
/// Parts of predictions: the array as a person feels it, and the chain of taps that the low-speed observer
/// pulls together: (I + K) x = m, K the Laplacian whose link i has the weight
/// k_i = (sigma / (sigma_v (t_(i+1) - t_i)))^2.
#pragma once

#include <functional>
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

/// Returns the array with its tactors at the places where they are felt.
/// \throws error (bad_input) as predict_percept() does.
array felt_array(const array& a, const person& who);

/// Returns factors on amplitudes by tactor; empty if all are 1.
/// \throws error (bad_input) as predict_percept() does.
std::vector<double> person_gains(const array& a, const person& who);

/// Returns summarise() of predict_percept() for each plan, equal to the last bit. Stores no samples, and
/// looks the target up once for all plans. Passes the samples of each plan to `each`, without their speeds.
/// \throws error (bad_input) as predict_percept().
std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans,
                                               const std::function<void(const percept_sample&)>& each = {});

} // namespace tactor::detail
