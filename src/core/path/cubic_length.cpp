// SPDX-License-Identifier: MIT
#include "core/path/shape.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include <boost/math/quadrature/gauss.hpp>

#include "core/clones.hpp"

namespace tactor::detail {
namespace {

using rule = boost::math::quadrature::gauss<double, 15>;

/// Nodes in whole vectors; the last one is not used.
constexpr std::size_t lanes = 16;
using nodes = std::array<double, lanes>;

/// Coefficients of the derivative, without their binomial factors.
struct hodograph {
    point first;
    point second;
    point third;
};

TACTOR_CLONES void speeds(const hodograph& h, const nodes& parameters, nodes& out) noexcept
{
    const double* __restrict in = parameters.data();
    double* __restrict v = out.data();
    const auto [ax, ay] = h.first;
    const auto [bx, by] = h.second;
    const auto [cx, cy] = h.third;
    for (std::size_t i = 0; i < lanes; ++i) {
        const double t = in[i];
        const double r = 1.0 - t;
        const double a = 3.0 * r * r;
        const double b = 6.0 * r * t;
        const double c = 3.0 * t * t;
        const double dx = a * ax + b * bx + c * cx;
        const double dy = a * ay + b * by + c * cy;
        v[i] = std::sqrt(dx * dx + dy * dy);
    }
}

} // namespace

// Adds in the order of Boost's sum: the middle node first, then pairs outwards.
double cubic_length(const cubic& c, double from, double to) noexcept
{
    const auto& x = rule::abscissa();
    const auto& w = rule::weights();
    const double middle = (from + to) * 0.5;
    const double half = (to - from) * 0.5;
    nodes at{};
    at[0] = middle;
    for (std::size_t i = 1; i < x.size(); ++i) {
        at[2 * i - 1] = middle + half * x[i];
        at[2 * i] = middle + half * -x[i];
    }
    nodes v{};
    speeds({c.p[1] - c.p[0], c.p[2] - c.p[1], c.p[3] - c.p[2]}, at, v);
    double sum = v[0] * w[0];
    for (std::size_t i = 1; i < x.size(); ++i)
        sum += (v[2 * i - 1] + v[2 * i]) * w[i];
    return half * sum;
}

} // namespace tactor::detail
