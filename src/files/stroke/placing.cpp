// SPDX-License-Identifier: MIT
#include "files/stroke/placing.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include <tactor/error.hpp>

#include "core/moved.hpp"

namespace tactor::detail {
namespace {

constexpr double largest_scale = 1e6;
constexpr double most_degrees = 3600.0;
constexpr std::array<std::string_view, 4> placing_keys{"scale", "rotate_deg", "translate_mm", "mirror"};

struct turned {
    double cosine = 1.0;
    double sine = 0.0;
};

// Quarter turns are exact.
turned turn_of(double degrees)
{
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) {
        constexpr std::array<turned, 4> exact{{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}};
        const double rest = std::fmod(quarters, 4.0);
        return exact[static_cast<std::size_t>(rest < 0.0 ? rest + 4.0 : rest)];
    }
    const double angle = degrees * std::numbers::pi / 180.0;
    return {std::cos(angle), std::sin(angle)};
}

} // namespace

stroke placed(const toml_table& t, stroke s)
{
    std::string_view first;
    for (const std::string_view key : placing_keys)
        if (first.empty() && t.has(key))
            first = key;
    const auto about = t.place("about_mm");
    if (first.empty()) {
        if (about)
            t.fail("about_mm", "nothing is scaled, turned or mirrored about it",
                   "add scale, rotate_deg or mirror, or leave it out");
        return s;
    }
    const double scale = t.number("scale", {0.0, largest_scale, true}).value_or(1.0);
    const turned turn = turn_of(t.number("rotate_deg", {-most_degrees, most_degrees}).value_or(0.0));
    const std::string mirror = t.choice("mirror", {"x", "y"}).value_or("");
    const point by = t.place("translate_mm").value_or(point{});
    const point from = about.value_or(point{});
    const double x = mirror == "x" ? -scale : scale;
    const double y = mirror == "y" ? -scale : scale;
    const affine m{x * turn.cosine, x * turn.sine,       -y * turn.sine,
                   y * turn.cosine, from.x_mm + by.x_mm, from.y_mm + by.y_mm};
    try {
        s.motion = moved(s.motion, from, m, {}, [&] { return std::string(first); });
        if (s.speed_mm_s && s.motion.length_mm() > 0.0)
            s.motion = s.motion.with_speed(*s.speed_mm_s);
    } catch (const error& e) {
        t.fail(first, e.what(), {});
    }
    return s;
}

} // namespace tactor::detail
