// SPDX-License-Identifier: MIT
// Keys that mirror, scale, turn and move a stroke of a TOML file.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_placing_test {

using namespace tactor;

namespace {

stroke one(const std::string& body)
{
    return parse_strokes_toml("[stroke]\n" + body + "\n", "w.toml").front();
}

std::string complaint(const std::string& body)
{
    return caught_message([&] { one(body); });
}

const std::string bend = "path = \"M 10 0 C 20 0 30 10 30 30 L 30 40\"\nduration_s = 2.0\n";
const std::string dots = "timed = [[0, 10, 0, 0.5], [0.5, 30, 10, 1.0], [2.0, 30, 40, 0.25]]\n";

/// Checks that each place of the placed stroke is that of the drawn one, mapped by hand, at the same part of
/// the time.
template <class Map>
void check_mapped(const std::string& keys, Map&& map)
{
    for (const std::string& drawn : {bend, dots}) {
        const stroke as_drawn = one(drawn);
        const stroke placed = one(drawn + keys);
        CAPTURE(keys);
        REQUIRE(placed.motion.duration_s() == as_drawn.motion.duration_s());
        for (int i = 0; i <= 50; ++i) {
            const double t = 2.0 * i / 50.0;
            CHECK(distance_mm(placed.motion.position(t), map(as_drawn.motion.position(t))) < 2e-3);
            CHECK(placed.motion.intensity(t) == as_drawn.motion.intensity(t));
        }
    }
}

} // namespace

TEST_CASE("keys place a stroke in order: mirror, scale, turn, move")
{
    check_mapped("scale = 0.5", [](point p) { return point{0.5 * p.x_mm, 0.5 * p.y_mm}; });
    check_mapped("translate_mm = [3, -4]", [](point p) { return point{p.x_mm + 3.0, p.y_mm - 4.0}; });
    check_mapped("mirror = \"x\"", [](point p) { return point{-p.x_mm, p.y_mm}; });
    check_mapped("mirror = \"y\"\nabout_mm = [20, 20]", [](point p) { return point{p.x_mm, 40.0 - p.y_mm}; });
    check_mapped("rotate_deg = 90", [](point p) { return point{-p.y_mm, p.x_mm}; }); // clockwise on a screen
    check_mapped("rotate_deg = -450\nabout_mm = [20, 20]", [](point p) {
        return point{20.0 + (p.y_mm - 20.0), 20.0 - (p.x_mm - 20.0)};
    });
    check_mapped("rotate_deg = 30", [](point p) {
        const double c = std::sqrt(0.75);
        return point{c * p.x_mm - 0.5 * p.y_mm, 0.5 * p.x_mm + c * p.y_mm};
    });
    check_mapped("translate_mm = [1, 2]\nrotate_deg = 90\nscale = 2\nmirror = \"x\"\nabout_mm = [10, 20]",
                 [](point p) {
                     const point m{-2.0 * (p.x_mm - 10.0), 2.0 * (p.y_mm - 20.0)};
                     return point{10.0 - m.y_mm + 1.0, 20.0 + m.x_mm + 2.0};
                 });
}

TEST_CASE("quarter turns and doubling are exact, and no key changes nothing")
{
    const stroke s = one("points = [[1, 2], [5, 2]]\nrotate_deg = 180\nscale = 2");
    CHECK(s.motion.position(0.0) == point{-2.0, -4.0});
    CHECK(one(bend).motion.position(0.77) == one(bend + "scale = 1").motion.position(0.77));
}

TEST_CASE("a placed stroke keeps its given speed, or its given time")
{
    const std::string line = "points = [[0, 0], [10, 0]]\nscale = 3\n";
    CHECK(one(line + "speed_mm_s = 15").motion.duration_s() == doctest::Approx(2.0));
    CHECK(one(line + "duration_s = 0.25").motion.duration_s() == 0.25);
    CHECK(one(line).motion.duration_s() == doctest::Approx(0.5)); // the usual 60 mm/s
    CHECK(one("preset = \"park2016-1\"\nscale = 0.5").motion.duration_s() == 1.4);
    CHECK(one("preset = \"park2016-1\"\nscale = 0.5").motion.length_mm() ==
          doctest::Approx(0.5 * one("preset = \"park2016-1\"").motion.length_mm()).epsilon(1e-6));
}

TEST_CASE("their faults have their place")
{
    const std::string line = "points = [[0, 0], [10, 0]]\n";
    for (const auto& [key, wrong] :
         {std::pair{"scale", "0"}, std::pair{"scale", "-1"}, std::pair{"scale", "\"2\""},
          std::pair{"scale", "nan"}, std::pair{"rotate_deg", "4000"}, std::pair{"rotate_deg", "[90]"},
          std::pair{"translate_mm", "3"}, std::pair{"translate_mm", "[1, 2, 3]"},
          std::pair{"translate_mm", "[1e9, 0]"}, std::pair{"mirror", "\"z\""}, std::pair{"mirror", "true"},
          std::pair{"about_mm", "[1]"}}) {
        const std::string said = complaint(line + "rotate_deg_ = 1\n");
        CHECK(said.find("did you mean 'rotate_deg'?") != std::string::npos);
        const std::string why = complaint(line + fmt::format("{} = {}", key, wrong));
        CAPTURE(why);
        CHECK(why.find("w.toml:3:") == 0);
        CHECK(why.find(key) != std::string::npos);
    }
    CHECK(complaint(line + "about_mm = [1, 2]").find("nothing is scaled") != std::string::npos);
    CHECK(complaint("points = [[0, 0], [1e6, 0]]\nscale = 10").find("w.toml:3:") == 0);
}

} // namespace stroke_placing_test
