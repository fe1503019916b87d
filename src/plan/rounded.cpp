// SPDX-License-Identifier: MIT
#include "plan/rounded.hpp"

#include <cmath>

#include <fmt/format.h>

namespace tactor::detail {
namespace {

// Distance from a whole number of nanoseconds that is rounding in the last digits.
constexpr double slack = 1e-4;

std::string seconds(double nanoseconds)
{
    std::string s = fmt::format("{:.9f}", nanoseconds * 1e-9);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.')
        s.pop_back();
    return s;
}

} // namespace

std::string seconds_up(double t_s)
{
    return seconds(std::ceil(t_s * 1e9 - slack));
}

std::string seconds_down(double t_s)
{
    return seconds(std::floor(t_s * 1e9 + slack));
}

std::string place(point p)
{
    // Adding 0 turns -0 into 0.
    const auto micrometres = [](double v) { return std::round(v * 1e3) / 1e3 + 0.0; };
    return fmt::format("({:.3f}, {:.3f}) mm", micrometres(p.x_mm), micrometres(p.y_mm));
}

} // namespace tactor::detail
