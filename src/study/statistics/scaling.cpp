// SPDX-License-Identifier: MIT
#include "study/statistics/scaling.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace tactor::study {
namespace {

using matrix = std::vector<std::vector<double>>;

// Returns -1/2 times the squared differences, minus the means of rows and columns (double centring).
matrix centre(const matrix& differences)
{
    const std::size_t n = differences.size();
    matrix b(n, std::vector<double>(n));
    std::vector<double> means(n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < n; ++k) {
            b[i][k] = -0.5 * differences[i][k] * differences[i][k];
            means[i] += b[i][k] / static_cast<double>(n);
        }
    const double all = std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < n; ++k)
            b[i][k] += all - means[i] - means[k];
    return b;
}

// Rotates rows and columns p and q of a symmetric matrix so that the element (p, q) becomes 0. Rotates the
// columns p and q of `vectors` by the same angle.
void rotate(matrix& a, matrix& vectors, std::size_t p, std::size_t q)
{
    const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[q][q] - a[p][p]);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const auto turn = [c, s](double& x, double& y) {
        std::tie(x, y) = std::pair(c * x - s * y, s * x + c * y);
    };
    for (std::vector<double>& row : a)
        turn(row[p], row[q]);
    for (std::size_t k = 0; k < a.size(); ++k)
        turn(a[p][k], a[q][k]);
    for (std::vector<double>& row : vectors)
        turn(row[p], row[q]);
}

// Diagonalises a symmetric matrix by Jacobi's rotations; returns its eigenvectors as columns.
matrix diagonalise(matrix& a)
{
    const std::size_t n = a.size();
    matrix vectors(n, std::vector<double>(n));
    for (std::size_t i = 0; i < n; ++i)
        vectors[i][i] = 1.0;
    constexpr int sweeps = 20; // enough, because the last sweeps converge quadratically
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (std::size_t p = 0; p < n; ++p)
            for (std::size_t q = p + 1; q < n; ++q)
                if (a[p][q] != 0.0)
                    rotate(a, vectors, p, q);
    return vectors;
}

} // namespace

scaled_items scale_items(const matrix& differences)
{
    const std::size_t n = differences.size();
    matrix b = centre(differences);
    const matrix vectors = diagonalise(b);
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, [&b](std::size_t x, std::size_t y) { return b[x][x] > b[y][y]; });
    scaled_items s{std::vector<std::array<double, 2>>(n, {0.0, 0.0})};
    for (std::size_t k = 0; k < std::min<std::size_t>(n, 2); ++k) {
        const std::size_t at = order[k];
        const double length = std::sqrt(std::max(0.0, b[at][at]));
        double farthest = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            s.places[i][k] = vectors[i][at] * length + 0.0; // changes -0 to 0
            if (std::abs(s.places[i][k]) > std::abs(farthest) * (1.0 + 1e-9))
                farthest = s.places[i][k];
        }
        if (farthest < 0.0)
            for (auto& place : s.places)
                place[k] = 0.0 - place[k];
    }
    double off = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = i + 1; k < n; ++k) {
            const double distance =
                std::hypot(s.places[i][0] - s.places[k][0], s.places[i][1] - s.places[k][1]);
            off += std::pow(distance - differences[i][k], 2.0);
            all += distance * distance;
        }
    s.stress = all > 0.0 ? std::sqrt(off / all) : 0.0;
    return s;
}

} // namespace tactor::study
