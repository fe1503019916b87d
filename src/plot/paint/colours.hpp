// SPDX-License-Identifier: MIT
/// \file
/// Colours that colour-blind people and black-and-white printers can tell apart.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactor::plot {

struct colour {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    double alpha = 1.0;

    friend bool operator==(const colour&, const colour&) = default;
};

inline constexpr colour black{0, 0, 0};
inline constexpr colour ink{34, 34, 34};
inline constexpr colour dark_grey{90, 90, 90};
inline constexpr colour grey{150, 150, 150};
inline constexpr colour light_grey{215, 215, 215};
inline constexpr colour pale{243, 243, 243};
inline constexpr colour white{255, 255, 255};

/// For lines that stand for things and not for numbers, from the palette of Okabe and Ito; each also differs
/// in lightness from the others.
inline constexpr colour blue{0, 114, 178};
inline constexpr colour orange{230, 159, 0};
inline constexpr colour vermilion{213, 94, 0};

/// Colour of u in 0 ... 1 (clamped): dark to light, and evenly so in grey. The map "viridis" of Smith and van
/// der Walt without its lightest end, which is lost on white paper.
colour ordered(double u) noexcept;

/// The same colour, seen through.
constexpr colour with_alpha(colour c, double alpha) noexcept
{
    c.alpha = alpha;
    return c;
}

/// How many strokes have a colour of their own.
inline constexpr std::size_t stroke_colours = 10;

/// Colour of the n-th stroke, from 0; they repeat after `stroke_colours`. Chosen so that any two differ by
/// more than 20 in CIELAB for normal sight and for protan, deutan and tritan sight alike (model of Machado et
/// al.).
colour of_stroke(std::size_t n) noexcept;

} // namespace tactor::plot
