// SPDX-License-Identifier: MIT
/// \file
/// Symmetric positive definite equations in which nothing is farther than five from the diagonal.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tactor::detail {

/// A matrix, then its Cholesky factor.
class band {
public:
    static constexpr std::size_t reach = 5;

    explicit band(std::size_t n) : rows_(n) {}

    void clear();
    /// The element in row r and column c <= r, at most `reach` apart.
    double& at(std::size_t r, std::size_t c) { return rows_[r][r - c]; }
    /// False where it is not positive definite to rounding.
    bool factor();
    /// Replaces b by the solution. Needs factor().
    void solve(std::vector<double>& b) const;

private:
    std::vector<std::array<double, reach + 1>> rows_;
};

} // namespace tactor::detail
