// SPDX-License-Identifier: MIT
#include "percept/hull_fit.hpp"

#include <algorithm>
#include <cmath>

namespace tactor::detail {

void band::clear()
{
    std::fill(rows_.begin(), rows_.end(), std::array<double, reach + 1>{});
}

bool band::factor()
{
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const std::size_t first = r - std::min(r, reach);
        for (std::size_t c = first; c <= r; ++c) {
            double v = rows_[r][r - c];
            for (std::size_t i = std::max(first, c - std::min(c, reach)); i < c; ++i)
                v -= rows_[r][r - i] * rows_[c][c - i];
            if (c < r)
                rows_[r][r - c] = v / rows_[c][0];
            else if (v > 0.0 && std::isfinite(v))
                rows_[r][0] = std::sqrt(v);
            else
                return false;
        }
    }
    return true;
}

void band::solve(std::vector<double>& b) const
{
    const std::size_t n = rows_.size();
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t i = r - std::min(r, reach); i < r; ++i)
            b[r] -= rows_[r][r - i] * b[i];
        b[r] /= rows_[r][0];
    }
    for (std::size_t r = n; r-- > 0;) {
        for (std::size_t i = r + 1; i < std::min(n, r + reach + 1); ++i)
            b[r] -= rows_[i][i - r] * b[i];
        b[r] /= rows_[r][0];
    }
}

} // namespace tactor::detail
