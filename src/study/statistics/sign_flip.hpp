// SPDX-License-Identifier: MIT
/// \file
/// Fisher's exact test of differences by all changes of their signs.
#pragma once

#include <optional>
#include <span>

namespace tactor::study {

/// The share of all 2^n choices of signs with which the sum of the values is as far from 0 as it is, or
/// farther. Exact: sums that differ by no more than rounding are the same. Up to 40 values of any kind, and
/// more where many sums are equal, as those of per cents are; else nothing, as for no values.
std::optional<double> sign_flip_p(std::span<const double> values);

} // namespace tactor::study
