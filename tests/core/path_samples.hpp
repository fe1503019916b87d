// SPDX-License-Identifier: MIT
// Curves to try paths on, and a plain reference for their arc length.
#pragma once

#include <array>
#include <charconv>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <tactor/path.hpp>

namespace tactor::test {

/// Each "M x y C x y x y x y", absolute.
inline constexpr std::array awkward_curves{
    "M 0 0 C 10 10 0 10 10 0",          // cusp
    "M 0 0 C 30 0 -20 0 10 0",          // back and forth on a line
    "M 0 0 C 0 0 0 0 10 0",             // both handles at the start
    "M 0 0 C 0 0 10 0 10 0",            // handles of no length
    "M 0 0 C 10 0 10 0 10 0",           // both handles at the end
    "M 0 0 C 20 20 -10 20 10 0",        // loop
    "M 0 0 C 10 10 1e-9 10 10 0",       // nearly a cusp
    "M 0 0 C 13 7 -3 7 10 0",           // narrow turn
    "M 5 5 C 25 5 -15 5 5 5",           // closed, on a line
    "M 0 0 C 1e-7 0 0 1e-7 30 40",      // tiny handles
    "M 0 0 C 100000 1 -100000 1 0 0.5", // long and flat
    "M 0 0 C 0 40 40 40 40 0",
};

struct walked {
    std::vector<double> s;
    std::vector<point> p;
};

/// Measures two million chords with the same numbers as the curve.
inline walked walk_cubic(std::string_view data)
{
    std::array<double, 8> c{};
    std::size_t at = 0;
    for (double& v : c) {
        at = data.find_first_of("-0123456789", at);
        at = static_cast<std::size_t>(std::from_chars(data.data() + at, data.data() + data.size(), v).ptr -
                                      data.data());
    }
    constexpr int steps = 2'000'000;
    walked w;
    w.s.reserve(steps + 1);
    w.p.reserve(steps + 1);
    long double length = 0.0L;
    for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        const double r = 1.0 - t;
        const double b0 = r * r * r, b1 = 3 * r * r * t, b2 = 3 * r * t * t, b3 = t * t * t;
        const point p{b0 * c[0] + b1 * c[2] + b2 * c[4] + b3 * c[6],
                      b0 * c[1] + b1 * c[3] + b2 * c[5] + b3 * c[7]};
        if (k > 0)
            length += static_cast<long double>(distance_mm(w.p.back(), p));
        w.p.push_back(p);
        w.s.push_back(static_cast<double>(length));
    }
    return w;
}

/// Makes path data of lines, arcs and Beziers within about 50 mm.
inline std::string random_path(std::mt19937_64& random, int segments)
{
    std::uniform_real_distribution<double> place(-50.0, 50.0);
    std::uniform_int_distribution<int> kind(0, 4);
    std::uniform_int_distribution<int> flag(0, 1);
    const auto n = [&] { return place(random); };
    std::string d = fmt::format("M {} {}", n(), n());
    for (int i = 0; i < segments; ++i) {
        switch (kind(random)) {
        case 0:
            d += fmt::format(" L {} {}", n(), n());
            break;
        case 1:
            d += fmt::format(" C {} {} {} {} {} {}", n(), n(), n(), n(), n(), n());
            break;
        case 2:
            d += fmt::format(" q {} {} {} {}", n(), n(), n(), n());
            break;
        case 3:
            d += fmt::format(" S {} {} {} {}", n(), n(), n(), n());
            break;
        default:
            d += fmt::format(" A {} {} {} {} {} {} {}", 1.0 + std::abs(n()), 1.0 + std::abs(n()), n(),
                             flag(random), flag(random), n(), n());
        }
    }
    return d;
}

} // namespace tactor::test
