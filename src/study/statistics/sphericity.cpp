// SPDX-License-Identifier: MIT
#include "study/statistics/sphericity.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>

namespace tactor::study {
namespace {

double trace(const std::vector<std::vector<double>>& m)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < m.size(); ++i)
        sum += m[i][i];
    return sum;
}

// Of a symmetric matrix that has no negative eigenvalues, by Cholesky; 0 where one is 0.
double determinant(std::vector<std::vector<double>> m)
{
    double product = 1.0;
    for (std::size_t k = 0; k < m.size(); ++k) {
        // The largest that is left comes first, so that what remains of a singular matrix is rounding alone.
        std::size_t best = k;
        for (std::size_t i = k; i < m.size(); ++i)
            best = m[i][i] > m[best][best] ? i : best;
        std::swap(m[k], m[best]);
        for (auto& row : m)
            std::swap(row[k], row[best]);
        if (!(m[k][k] > 0.0))
            return 0.0;
        product *= m[k][k];
        for (std::size_t i = k + 1; i < m.size(); ++i)
            for (std::size_t j = k + 1; j < m.size(); ++j)
                m[i][j] -= m[i][k] * m[k][j] / m[k][k];
    }
    return product;
}

double upper_chi_squared(double x, double df)
{
    return boost::math::cdf(
        boost::math::complement(boost::math::chi_squared_distribution<>(df), std::max(0.0, x)));
}

} // namespace

double greenhouse_geisser(const std::vector<std::vector<double>>& cross)
{
    double squares = 0.0;
    for (const auto& row : cross)
        for (const double v : row)
            squares += v * v;
    const double sum = trace(cross);
    return std::min(1.0, sum * sum / (static_cast<double>(cross.size()) * squares)); // but for rounding
}

std::optional<mauchly_test> mauchly(const std::vector<std::vector<double>>& cross, std::size_t df,
                                    std::size_t cells)
{
    if (df < cross.size())
        return {};
    const auto p = static_cast<double>(cross.size());
    const auto n = static_cast<double>(df);
    std::vector<std::vector<double>> scaled = cross;
    for (auto& row : scaled)
        for (double& v : row)
            v *= p / trace(cross);
    const double w = std::min(1.0, determinant(std::move(scaled)));
    // What is singular has a w of rounding errors, some 1e-16.
    if (w < 1e-13)
        return {};
    const double rho = 1.0 - (2.0 * p * p + p + 2.0) / (6.0 * p * n);
    const double second = (p + 2.0) * (p - 1.0) * (p - 2.0) *
                          (2.0 * p * p * p + 6.0 * p * p + 3.0 * static_cast<double>(cells) + 2.0) /
                          (288.0 * std::pow(n * p * rho, 2.0));
    const double z = -n * rho * std::log(w);
    const double f = p * (p + 1.0) / 2.0 - 1.0;
    const double p1 = upper_chi_squared(z, f);
    const double p2 = upper_chi_squared(z, f + 4.0);
    return mauchly_test{w, p1 + second * (p2 - p1)};
}

} // namespace tactor::study
