// SPDX-License-Identifier: MIT
// Keys that define how a stroke of a TOML file moves along its path.
#include <doctest/doctest.h>

#include <string>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_movement_test {

using namespace tactor;

namespace {

const std::string line = "points = [[0, 10], [40, 10]]\n";

stroke one(const std::string& body)
{
    return parse_strokes_toml("[stroke]\n" + body + "\n", "w.toml").front();
}

std::string complaint(const std::string& body)
{
    return caught_message([&] { one(body); });
}

void check_same(const trajectory& a, const trajectory& b)
{
    REQUIRE(a.duration_s() == doctest::Approx(b.duration_s()).epsilon(1e-14));
    for (int i = 0; i <= 40; ++i) {
        const double part = i / 40.0;
        CHECK(distance_mm(a.position(part * a.duration_s()), b.position(part * b.duration_s())) < 1e-9);
        CHECK(a.intensity(part * a.duration_s()) == doctest::Approx(b.intensity(part * b.duration_s())));
    }
}

} // namespace

TEST_CASE("easing, profiles and pauses of a file are those of the library")
{
    const path way = path::from_svg("M 0 10 L 40 10");
    check_same(one(line + "duration_s = 1.4\neasing = \"minimum-jerk\"").motion,
               trajectory::along(way, {.duration_s = 1.4, .easing = easing_kind::minimum_jerk}));
    check_same(one(line + "easing = \"in-out\"").motion,
               trajectory::along(way, {.easing = easing_kind::in_out}));
    check_same(one(line + "speed_mm_s = [[0, 20], [0.5, 80], [1, 20]]").motion,
               trajectory::along(way, {.speed_mm_s = {{0.0, 20.0}, {0.5, 80.0}, {1.0, 20.0}}}));
    check_same(one(line + "duration_s = 1.0\nintensity = [[0, 0.2], [1, 1.0]]").motion,
               trajectory::along(way, {.duration_s = 1.0, .intensity = {{0.0, 0.2}, {1.0, 1.0}}}));
    check_same(one(line + "duration_s = 2.0\npauses = [[0.5, 0.5], [1, 0.25, 0]]").motion,
               trajectory::along(way, {.duration_s = 2.0, .rests = {{0.5, 0.5}, {1.0, 0.25, 0.0}}}));
}

TEST_CASE("a duration is that of the whole, a speed and a preset's time are those of the movement")
{
    const std::string pause = "pauses = [[0.5, 0.5]]\n";
    CHECK(one(line + pause + "duration_s = 2.0").motion.duration_s() == 2.0);
    CHECK(one(line + pause + "speed_mm_s = 40").motion.duration_s() == doctest::Approx(1.5));
    CHECK(one(line + pause).motion.duration_s() == doctest::Approx(40.0 / 60.0 + 0.5));
    CHECK(one("preset = \"park2016-1\"\n" + pause).motion.duration_s() == doctest::Approx(1.9));
    CHECK(one("preset = \"park2016-1\"\nduration_s = 1.5\n" + pause).motion.duration_s() == 1.5);
    CHECK(one("preset = \"park2016-1\"\neasing = \"in-out\"").note == note_kind::reconstructed);
    CHECK(one("preset = \"park2016-1\"\nintensity = [[0, 0.5]]").motion.intensity(0.7) == 0.5);
}

TEST_CASE("a scaled stroke keeps its mean speed and its pauses")
{
    const std::string speeds = "speed_mm_s = [[0, 20], [1, 80]]\n";
    const stroke s = one(line + speeds + "pauses = [[0.5, 0.5]]");
    const double moving = s.motion.duration_s() - 0.5;
    CHECK(*s.speed_mm_s == doctest::Approx(40.0 / moving));
    const stroke half = one(line + speeds + "pauses = [[0.5, 0.5]]\nscale = 0.5");
    CHECK(half.motion.duration_s() == doctest::Approx(0.5 * moving + 0.5));
    CHECK(half.motion.position(0.5 * moving + 0.5).x_mm == doctest::Approx(20.0));
    CHECK(one(line + "duration_s = 2.0\neasing = \"in-out\"\nscale = 0.5").motion.duration_s() == 2.0);
}

TEST_CASE("without these keys nothing changes, to the bit")
{
    const stroke s = one("path = \"M 0 10 C 20 -5 20 45 40 30\"\nspeed_mm_s = 37.0\nintensity = 0.3");
    const path way = path::from_svg("M 0 10 C 20 -5 20 45 40 30");
    const trajectory t = trajectory::along(way, way.length_mm() / 37.0, 0.3);
    REQUIRE(s.motion.duration_s() == t.duration_s());
    for (int i = 0; i <= 100; ++i)
        CHECK(s.motion.position(t.duration_s() * i / 100.0) == t.position(t.duration_s() * i / 100.0));
}

TEST_CASE("their faults have their place")
{
    for (const auto& [key, wrong] : {
             std::pair{"easing", "\"fast\""},
             std::pair{"easing", "3"},
             std::pair{"speed_mm_s", "[]"},
             std::pair{"speed_mm_s", "[60]"},
             std::pair{"speed_mm_s", "[[0, 60], [0, 30]]"},
             std::pair{"speed_mm_s", "[[0.5, 60], [0.2, 30]]"},
             std::pair{"speed_mm_s", "[[0, 0]]"},
             std::pair{"speed_mm_s", "[[1.5, 60]]"},
             std::pair{"speed_mm_s", "[[0, 1e-6]]"},
             std::pair{"speed_mm_s", "\"fast\""},
             std::pair{"intensity", "[[0, 1.5]]"},
             std::pair{"intensity", "[[0, -1]]"},
             std::pair{"intensity", "[[0, \"1\"]]"},
             std::pair{"intensity", "[[nan, 1]]"},
             std::pair{"intensity", "[[0, 1, 2]]"},
             std::pair{"intensity", "{}"},
             std::pair{"pauses", "0.5"},
             std::pair{"pauses", "[]"},
             std::pair{"pauses", "[0.5, 0.3]"},
             std::pair{"pauses", "[[0.5]]"},
             std::pair{"pauses", "[[0.5, 0]]"},
             std::pair{"pauses", "[[0.5, 90000]]"},
             std::pair{"pauses", "[[0.5, 86400]]"},
             std::pair{"pauses", "[[0.5, 0.3, 2]]"},
             std::pair{"pauses", "[[0.5, 0.3, 1, 1]]"},
             std::pair{"pauses", "[[-0.1, 0.3]]"},
             std::pair{"pauses", "[[0.5, 0.3], [0.5, 0.3]]"},
         }) {
        const std::string why = complaint(line + fmt::format("{} = {}", key, wrong));
        CAPTURE(key);
        CAPTURE(wrong);
        CAPTURE(why);
        CHECK(why.find("w.toml:3:") == 0);
    }
    CHECK(complaint(line + "duration_s = 0.3\npauses = [[0.5, 0.3]]").find("w.toml:4:") == 0);
    CHECK(complaint(line + "duration_s = 1.0\nspeed_mm_s = [[0, 1]]")
              .find("has both duration_s and speed_mm_s") != std::string::npos);
    CHECK(complaint(line + "easing_ = 1").find("did you mean 'easing'?") != std::string::npos);
    CHECK(complaint(line + "pause = 1").find("did you mean 'pauses'?") != std::string::npos);
    for (const std::string key :
         {"easing = \"in-out\"", "pauses = [[0.5, 0.3]]", "intensity = [[0, 1]]", "speed_mm_s = [[0, 30]]"}) {
        const std::string why = complaint("timed = [[0, 0, 0], [1, 40, 0]]\n" + key);
        CHECK(why.find("w.toml:3:") == 0);
        CHECK(why.find("timed points have times") != std::string::npos);
    }
}

} // namespace stroke_movement_test
