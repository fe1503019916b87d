// SPDX-License-Identifier: MIT
// Places on a curve by arc length without inverting it, for strokes that ask for one each millisecond.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

class arc_length;

/// Polynomials in the arc length, off by less than 1e-9 mm, or by the last digits of a curve of kilometres.
class curve_places {
public:
    /// Gives up with more than `most` pieces.
    curve_places(const shape& c, const arc_length& measure, std::size_t most);

    /// Returns the place at an arc length from 0 to the curve's.
    point at(double s_mm) const noexcept;
    std::size_t pieces() const noexcept { return pieces_.size(); }

private:
    static constexpr std::size_t nodes = 7;

    /// In Newton's form: c[0] + (s - s[0]) (c[1] + (s - s[1]) (c[2] + ...)).
    struct piece {
        std::array<double, nodes> s;
        std::array<point, nodes> c;

        point at(double s_mm) const noexcept;
    };

    std::vector<double> ends_mm_;
    std::vector<piece> pieces_;
};

/// Returns the path with such polynomials for the curves on which a target that does about `step_mm` at a
/// time stays for long. Its places differ by less than 1e-9 mm.
path with_places(const path& p, double step_mm);

} // namespace tactor::detail
