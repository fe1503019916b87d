// SPDX-License-Identifier: MIT
/// \file
/// Whether the differences between levels vary alike, and what follows where they do not.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tactor::study {

/// Epsilon of Greenhouse and Geisser (1959), 1 / rows ... 1, from the cross products of orthonormal contrasts
/// (at least two; not all 0).
double greenhouse_geisser(const std::vector<std::vector<double>>& cross);

struct mauchly_test {
    double w;
    double p;
};

/// Mauchly's test (1940) with the correction to the second order that R has, in mauchly.test() and in car:
/// one of its terms counts all `cells` of the design, not the contrasts. `df`: participants - 1.
/// Nothing where df is less than the number of contrasts, or the matrix is singular.
std::optional<mauchly_test> mauchly(const std::vector<std::vector<double>>& cross, std::size_t df,
                                    std::size_t cells);

} // namespace tactor::study
