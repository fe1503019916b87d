// SPDX-License-Identifier: MIT
/// \file
/// The weights of the sides of an array's edge on one tap.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <tactor/geometry.hpp>

#include "plan/faces/sides.hpp"

namespace tactor::detail {

/// D = sum_e w_e out_e out_e' of a tap, for weights above 0 and sides that close a figure, and its inverse,
/// in a frame whose first axis is the heaviest side's direction. Weights may be 1e16 apart; in any other
/// frame rounding would mix the axes.
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
        const double det = uu * vv - uv * uv; // uu >= the heaviest: little is cancelled
        inverse_ = {vv / det, -uv / det, uu / det};
    }

    /// Elements uu, uv, vv of D^-1.
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
    /// Direction of a side in the frame.
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

} // namespace tactor::detail
