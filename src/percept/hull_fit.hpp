// SPDX-License-Identifier: MIT
/// \file
/// Places at which taps must be played to be felt as near to their targets as an array allows: a convex
/// quadratic programme, and the equations of its steps.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <tactor/path.hpp>

#include "plan/faces/sides.hpp"

namespace tactor::detail {

/// Most constraints: one for each tap and side, four numbers of eight bytes each.
inline constexpr std::size_t most_fit_constraints = 4'000'000;

/// Returns the m with dot(out, m_i) <= reach for all sides that minimises sum |x(m) - targets|^2, where (I +
/// K) x = m (low_speed.hpp). Uses an interior-point method (Mehrotra 1992) with banded steps: O(n sides),
/// some twenty times. The sum is within 1e-16 n of its minimum in units of the array's size squared, by its
/// duality gap; within 1e-10 n if rounding ends the search before. `inside`: a point that keeps all sides. No
/// `give` may be 0.
/// \throws error (bad_input) for more constraints than fit, or links too strong for sixteen digits.
std::vector<point> fit_inside(std::span<const double> give, std::span<const point> targets,
                              const std::vector<beyond>& sides, point inside);

/// Weights of the sides of an array's edge on one tap: D = sum_e w_e out_e out_e', for weights above 0 and
/// sides that close a figure; and its inverse, in a frame whose first axis is the heaviest side's direction.
/// Weights may be 1e16 apart; in any other frame rounding would mix the axes.
class tap_frame {
public:
    template <class Weight>
    tap_frame(const std::vector<beyond>& sides, Weight&& weight) : sides_(&sides)
    {
        for (std::size_t e = 1; e < sides.size(); ++e)
            if (weight(e) > weight(heaviest_))
                heaviest_ = e;
        u_ = sides[heaviest_].out;
        double uu = 0.0;
        double uv = 0.0;
        double vv = 0.0;
        for (std::size_t e = 0; e < sides.size(); ++e) {
            const point o = out(e);
            uu += weight(e) * o.x_mm * o.x_mm;
            uv += weight(e) * o.x_mm * o.y_mm;
            vv += weight(e) * o.y_mm * o.y_mm;
        }
        const double det = uu * vv - uv * uv; // uu >= the heaviest: little cancels
        inverse_ = {vv / det, -uv / det, uu / det};
    }

    /// Returns the elements uu, uv, vv of D^-1.
    const std::array<double, 3>& inverse() const { return inverse_; }
    point times_inverse(point p) const
    {
        return {inverse_[0] * p.x_mm + inverse_[1] * p.y_mm, inverse_[1] * p.x_mm + inverse_[2] * p.y_mm};
    }
    point into(point p) const { return {dot(u_, p), u_.x_mm * p.y_mm - u_.y_mm * p.x_mm}; }
    point back(point p) const
    {
        return {u_.x_mm * p.x_mm - u_.y_mm * p.y_mm, u_.y_mm * p.x_mm + u_.x_mm * p.y_mm};
    }
    /// Returns the direction of a side in the frame.
    point out(std::size_t side) const
    {
        return side == heaviest_ ? point{1.0, 0.0} : into((*sides_)[side].out);
    }
    const point& axis() const { return u_; }

private:
    const std::vector<beyond>* sides_;
    std::size_t heaviest_ = 0;
    point u_;
    std::array<double, 3> inverse_{};
};

/// A symmetric positive definite matrix whose elements beyond five from the diagonal are 0; then its Cholesky
/// factor.
class band {
public:
    static constexpr std::size_t reach = 5;

    explicit band(std::size_t n) : rows_(n) {}

    void clear();
    /// Returns the element in row r and column c <= r, at most `reach` apart.
    double& at(std::size_t r, std::size_t c) { return rows_[r][r - c]; }
    /// Replaces the matrix by its factor. Returns false if it is not positive definite to rounding.
    bool factor();
    /// Replaces b by the solution. Call factor() first.
    void solve(std::vector<double>& b) const;

private:
    std::vector<std::array<double, reach + 1>> rows_;
};

} // namespace tactor::detail
