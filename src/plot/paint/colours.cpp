// SPDX-License-Identifier: MIT
#include "plot/paint/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tactor::plot {
namespace {

constexpr std::array<colour, 9> anchors{{{68, 1, 84},
                                         {71, 44, 122},
                                         {59, 81, 139},
                                         {44, 113, 142},
                                         {33, 144, 141},
                                         {39, 173, 129},
                                         {92, 200, 99},
                                         {170, 220, 50},
                                         {253, 231, 37}}};
constexpr double lightest = 0.92;

std::uint8_t mixed(std::uint8_t a, std::uint8_t b, double part) noexcept
{
    return static_cast<std::uint8_t>(std::lround(a + (b - a) * part));
}

} // namespace

colour ordered(double u) noexcept
{
    const double at = (std::isfinite(u) ? std::clamp(u, 0.0, 1.0) : 0.0) * lightest * (anchors.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(at), anchors.size() - 2);
    const double part = at - static_cast<double>(i);
    const colour a = anchors[i];
    const colour b = anchors[i + 1];
    return {mixed(a.r, b.r, part), mixed(a.g, b.g, part), mixed(a.b, b.b, part)};
}

colour stroke_colour(std::size_t n) noexcept
{
    constexpr std::array<colour, stroke_colours> all{{{26, 133, 255},
                                                      {230, 159, 0},
                                                      {51, 34, 136},
                                                      {34, 136, 51},
                                                      {170, 68, 153},
                                                      {102, 204, 238},
                                                      {102, 51, 51},
                                                      {119, 119, 119},
                                                      {0, 0, 0},
                                                      {187, 187, 187}}};
    return all[n % all.size()];
}

} // namespace tactor::plot
