// SPDX-License-Identifier: MIT
/// \file
/// Repeated-measures analysis of variance: every participant has a value in every cell.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tactor::study {

/// Values by participant and cell, the cells of two factors by rows: the second factor's levels follow each
/// other. All rows are as long as the product of the levels.
struct cell_table {
    std::vector<std::vector<double>> values = {}; ///< one row for each participant
    std::size_t first_levels = 1;                 ///< of the first factor; 1: there is only the second
    std::size_t second_levels = 1;
};

/// One effect against its own interaction with participants. What is not defined is not there: everything
/// with less than two participants or two levels, and where the error has no variance.
struct effect {
    double df1 = 0.0;
    double df2 = 0.0;
    std::optional<double> f = {};
    std::optional<double> p = {};
    std::optional<double> epsilon_gg = {}; ///< Greenhouse and Geisser 1959; where df1 >= 2, as the next three
    std::optional<double> p_gg = {};
    std::optional<double> mauchly_w = {}; ///< also where n - 1 >= df1 only, and not singular
    std::optional<double> mauchly_p = {};
    std::optional<double> eta2_partial = {};
    std::optional<double> eta2_generalised = {}; ///< SS / (SS + SS of participants + SS of all errors)
    std::optional<double> ms_error = {};         ///< 0 where the error has no variance
};

struct anova {
    effect first;
    effect second;
    effect interaction;
};

/// Both main effects and their interaction; of a factor with one level nothing.
anova repeated_measures(const cell_table& t);

/// Upper tail of F.
double p_of_f(double f, double df1, double df2);

} // namespace tactor::study
