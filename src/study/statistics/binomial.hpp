// SPDX-License-Identifier: MIT
/// \file
/// How well a share is known that was counted.
#pragma once

#include <cstddef>

#include "study/statistics/t_test.hpp"

namespace tactor::study {

/// The exact 95 % interval of Clopper and Pearson (1934) for the chance of what came `hits` times in `n`; n
/// is 1 or more.
interval binomial_interval(std::size_t hits, std::size_t n);

} // namespace tactor::study
