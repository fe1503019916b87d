// SPDX-License-Identifier: MIT
#include "study/statistics/bradley_terry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace tactor::study {
namespace {

using square_matrix = std::vector<std::vector<double>>;

// Returns the first item, and all items that chains of preferences connect to the first item in both
// directions.
std::vector<std::size_t> find_comparable_items(const square_matrix& wins)
{
    const std::size_t n = wins.size();
    std::vector<std::vector<bool>> leads(n, std::vector<bool>(n));
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b)
            leads[a][b] = a == b || wins[a][b] > 0.0;
    for (std::size_t by = 0; by < n; ++by)
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = 0; b < n; ++b)
                leads[a][b] = leads[a][b] || (leads[a][by] && leads[by][b]);
    std::vector<std::size_t> all;
    for (std::size_t a = 0; a < n; ++a)
        if (leads[0][a] && leads[a][0])
            all.push_back(a);
    return all;
}

// Inverts a symmetric positive definite matrix by Gauss-Jordan elimination.
square_matrix invert(square_matrix m)
{
    for (std::size_t k = 0; k < m.size(); ++k) {
        const double pivot = std::exchange(m[k][k], 1.0);
        for (double& v : m[k])
            v /= pivot;
        for (std::size_t i = 0; i < m.size(); ++i) {
            if (i == k)
                continue;
            const double factor = std::exchange(m[i][k], 0.0);
            for (std::size_t j = 0; j < m.size(); ++j)
                m[i][j] -= factor * m[k][j];
        }
    }
    return m;
}

// Derivatives of the log-likelihood with respect to the log worths of all items except the first.
struct derivatives {
    std::vector<double> gradient;
    square_matrix information; ///< negative second derivatives
};

derivatives find_derivatives(const square_matrix& wins, const std::vector<std::size_t>& items,
                             const std::vector<double>& log_worths)
{
    const std::size_t estimated = items.size() - 1;
    derivatives d{std::vector<double>(estimated), square_matrix(estimated, std::vector<double>(estimated))};
    for (std::size_t a = 1; a <= estimated; ++a)
        for (std::size_t b = 0; b <= estimated; ++b) {
            if (a == b)
                continue;
            const double won = wins[items[a]][items[b]];
            const double compared = won + wins[items[b]][items[a]];
            const double p = 1.0 / (1.0 + std::exp(log_worths[b] - log_worths[a]));
            d.gradient[a - 1] += won - compared * p;
            d.information[a - 1][a - 1] += compared * p * (1.0 - p);
            if (b > 0)
                d.information[a - 1][b - 1] = -compared * p * (1.0 - p);
        }
    return d;
}

} // namespace

std::vector<worth> fit_bradley_terry(const std::vector<std::vector<double>>& wins)
{
    constexpr int most_steps = 100;
    constexpr double longest_step = 1.0; // longer steps may lead away from the maximum
    constexpr double shortest_step = 1e-9;
    const std::vector<std::size_t> items = find_comparable_items(wins);
    std::vector<double> log_worths(items.size());
    square_matrix covariance;
    double longest = 1.0;
    for (int i = 0; i < most_steps && longest > shortest_step; ++i) { // Newton's method
        const derivatives d = find_derivatives(wins, items, log_worths);
        covariance = invert(d.information);
        std::vector<double> step;
        longest = 0.0;
        for (const std::vector<double>& row : covariance) {
            step.push_back(std::inner_product(row.begin(), row.end(), d.gradient.begin(), 0.0));
            longest = std::max(longest, std::abs(step.back()));
        }
        for (std::size_t k = 0; k < step.size(); ++k)
            log_worths[k + 1] += step[k] * longest_step / std::max(longest, longest_step);
    }
    std::vector<worth> all(wins.size());
    all[0] = {0.0, 0.0};
    for (std::size_t k = 1; k < items.size(); ++k)
        all[items[k]] = {log_worths[k], std::sqrt(covariance[k - 1][k - 1])};
    return all;
}

} // namespace tactor::study
