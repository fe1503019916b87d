// SPDX-License-Identifier: MIT
/// \file
/// Sensitivity by signal detection theory, and the exponent of magnitude estimates.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace tactor::study {

/// Returns (count + 0.5) / (n + 1), the log-linear correction (Hautus 1995) that keeps a rate off 0 and 1.
double corrected_rate(std::size_t count, std::size_t n);

struct sensitivity {
    double dprime;
    double c; ///< criterion in the unit of d'
};

/// Computes d' = z(hits) - z(false alarms) and c = -(z(hits) + z(false alarms)) / 2 of yes-no answers with
/// equal variances, from rates above 0 and below 1.
sensitivity yes_no(double hits, double false_alarms);

/// Computes d' of same-different answers by the differencing model (Macmillan and Creelman 2005), from the
/// rates of "different" to different and to same pairs, above 0 and below 1. c is the least difference that
/// is called "different". d' is 0 where hits are not above false alarms: the model has no such rates.
sensitivity same_different(double hits, double false_alarms);

/// Returns the exponent of Stevens's power law: the slope of log estimates over log values by least squares.
/// Dividing by the participant's geometric mean does not change it. Nothing with less than two different
/// values, or numbers that are not above 0. Both spans have the same length.
std::optional<double> stevens_exponent(std::span<const double> values, std::span<const double> estimates);

} // namespace tactor::study
