// SPDX-License-Identifier: MIT
// Touches of .tact files; tests/cli/test_content.py compares them with those of another reader.
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "files/stroke_format.hpp"
#include "has.hpp"

namespace stroke_tact_test {

using namespace tactor;

namespace {

std::vector<stroke> read(const std::string& text, std::string_view position = {})
{
    return parse_strokes(text, "a.tact", 1.0, position);
}

// Returns a file with one effect at 100 ms, and these modes.
std::string file(const std::string& modes)
{
    return R"({"project": {"layout": {"layouts": {"Left": [{"index": 0, "x": "0.25", "y": 0.333}, {"index": "1", "x": 1, "y": 1}]}},
"tracks": [{"enable": true, "effects": [{"startTime": "100", "offsetTime": 400, "modes": {)" +
           modes + "}}]}]}}";
}

std::string path(const std::string& touch)
{
    return file(
        R"("Left": {"mode": "PATH_MODE", "dotMode": {"feedback": [{"startTime": 0, "endTime": 9, "pointList": [{"index": 7, "intensity": 1}]}]},
"pathMode": {"feedback": [)" +
        touch + "]}}");
}

std::string dots(const std::string& touch)
{
    return file(R"("Left": {"mode": "DOT_MODE", "pathMode": null, "dotMode": {"feedback": [)" + touch +
                "]}}");
}

const std::string line =
    R"({"playbackType": "NONE", "pointList": [{"x": 0, "y": 0, "intensity": 1, "time": 50}, {"x": 1, "y": "0.5", "intensity": "0.5", "time": "250"}]})";

} // namespace

TEST_CASE("a path keeps the times of its points, from the start of its effect")
{
    const std::vector<stroke> all = read(path(line));
    REQUIRE(all.size() == 1);
    CHECK(all[0].name == "a");
    CHECK(all[0].start_s == doctest::Approx(0.15));
    CHECK(all[0].motion.duration_s() == 0.2);
    CHECK(all[0].motion.position(0.1).x_mm == doctest::Approx(0.5));
    CHECK(all[0].motion.intensity(0.1) == doctest::Approx(0.75));
    CHECK(all[0].fit == stroke_fit{.unit_square = true});
    CHECK(all[0].warnings.empty());
}

TEST_CASE("a path of one point is a tap as long as its effect, one of none is nothing, and of equal times "
          "the last counts")
{
    const std::string tap = R"({"pointList": [{"x": 0.668, "y": 1, "time": 0}], "playbackType": "FADE_OUT"})";
    const std::vector<stroke> all = read(path(tap + R"(, {"pointList": []}, )" + line));
    REQUIRE(all.size() == 2);
    CHECK(all[0].name == "a-1");
    CHECK(all[0].motion.duration_s() == 0.4);
    CHECK(all[0].motion.position(0.0).x_mm == 2.0 / 3.0);
    CHECK(all[0].motion.intensity(0.0) == 1.0); // without an intensity it is whole
    CHECK(all[0].motion.intensity(0.1) == doctest::Approx(0.75));
    CHECK(all[0].motion.intensity(0.4) == 0.0);
    const std::vector<stroke> equal = read(path(
        R"({"pointList": [{"x": 0, "y": 0, "time": 0}, {"x": 1, "y": 1, "time": 100}, {"x": 0.5, "y": 0, "time": 100}]})"));
    CHECK(equal.at(0).motion.position(0.1).x_mm == 0.5);
}

TEST_CASE("dots rest at the places of the file, with their fades")
{
    for (const auto& [fade, at_start, at_middle, at_end] :
         {std::tuple("NONE", 0.5, 0.5, 0.5), std::tuple("FADE_IN", 0.0, 0.25, 0.5),
          std::tuple("FADE_OUT", 0.5, 0.25, 0.0), std::tuple("FADE_IN_OUT", 0.0, 0.5, 0.0)}) {
        CAPTURE(fade);
        const std::vector<stroke> all = read(dots(
            R"({"startTime": 10, "endTime": "310", "playbackType": ")" + std::string(fade) +
            R"(", "pointList": [{"index": 0, "intensity": 0.5}, {"index": "1", "intensity": 0}]}, {"startTime": 5, "endTime": 5, "pointList": [{"index": 0}]})"));
        REQUIRE(all.size() == 2);
        CHECK(all[0].start_s == doctest::Approx(0.11));
        CHECK(all[0].motion.duration_s() == doctest::Approx(0.3));
        CHECK(all[0].motion.position(0.2).x_mm == 0.25);
        CHECK(all[0].motion.position(0.2).y_mm == 1.0 / 3.0);
        CHECK(all[0].motion.intensity(0.0) == at_start);
        CHECK(all[0].motion.intensity(all[0].motion.duration_s() / 2) == doctest::Approx(at_middle));
        CHECK(all[0].motion.intensity(1.0) == at_end);
    }
}

TEST_CASE("the product of a fade and a change of intensity is close to their curve")
{
    const std::vector<stroke> all = read(path(
        R"({"playbackType": "FADE_IN_OUT", "pointList": [{"x": 0, "y": 0, "intensity": 0, "time": 0}, {"x": 1, "y": 1, "intensity": 1, "time": 1000}]})"));
    for (int k = 0; k <= 1000; ++k) {
        const double u = k / 1000.0;
        const double wanted = u * (1.0 - std::abs(2.0 * u - 1.0));
        CHECK(std::abs(all.at(0).motion.intensity(u) - wanted) < 0.001);
    }
}

TEST_CASE("comments and commas at the end are skipped; depth, size and numbers are limited")
{
    CHECK(read("\xEF\xBB\xBF" + path("/* \" { */" + line + "," + " // [\n")).size() == 1);
    CHECK(read(dots(R"({"startTime": 0, "endTime": 1e2, "pointList": [{"index": 0, "intensity": "1",},],})"))
              .size() == 1);
    has(caught_message([] { read(R"({"tracks": )" + std::string(100, '[')); }), "nested more than 64 deep");
    has(caught_message([] { read("{\"tracks\": \"" + std::string(std::size_t{17} << 20U, ' ') + "\"}"); }),
        "larger than 16 MB");
    has(caught_message([] { read(path(R"({"pointList": [{"x": "inf", "y": 0, "time": 0}]})")); }),
        "project.tracks[0].effects[0].modes.Left.pathMode.feedback[0].pointList[0].x: inf is out of range");
    has(caught_message([] { read(path(line), "Right"); }),
        "position: nothing plays at 'Right' in a.tact (use one of Left)");
    has(caught_message([] { return parse_strokes("[stroke]\npath = \"M 0 0 H 4\"\n", "b", 1.0, "Left"); }),
        "position: b has no positions");
}

} // namespace stroke_tact_test
