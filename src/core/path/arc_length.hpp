// SPDX-License-Identifier: MIT
// Arc length of a curved piece and its inverse.
#pragma once

#include <vector>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Table of (parameter, arc length) so fine that Gauss quadrature from one entry towards the next is good to
/// about a nanometre, cusps included.
class arc_length {
public:
    explicit arc_length(const shape& c);

    double total() const noexcept { return s_.back(); }
    /// Arc length at a parameter from 0 to 1. `c` is the shape that the table was made of.
    double at(const shape& c, double t) const noexcept;
    /// Parameter at an arc length, clamped to 0 ... 1.
    double parameter(const shape& c, double s_mm) const noexcept;

private:
    bool even_; ///< the parameter goes with the length
    std::vector<double> t_;
    std::vector<double> s_;
    std::vector<double> speed_; ///< at those; none where the parameter goes with the length
};

} // namespace tactor::detail
