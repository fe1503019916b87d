// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <string>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_toml_test {

using namespace tactor;

namespace {

std::vector<stroke> read(const std::string& text)
{
    return parse_strokes_toml(text, "dir/wave.toml");
}

stroke one(const std::string& body, double intensity_max = 1.0)
{
    const std::vector<stroke> all =
        parse_strokes_toml("[stroke]\n" + body + "\n", "dir/wave.toml", intensity_max);
    REQUIRE(all.size() == 1);
    return all.front();
}

// Returns the fault of a stroke whose keys begin in line 2.
std::string complaint(const std::string& body)
{
    return caught_message(
        [&] { static_cast<void>(parse_strokes_toml("[stroke]\n" + body + "\n", "w.toml")); });
}

void check_near(point p, double x_mm, double y_mm)
{
    CHECK(distance_mm(p, {x_mm, y_mm}) < 1e-6);
}

} // namespace

TEST_CASE("a path takes the default speed, a speed, or a time")
{
    const stroke s = one("path = \"M 0 10 L 40 10\"");
    CHECK(s.name == "wave");
    CHECK(s.motion.length_mm() == doctest::Approx(40.0));
    CHECK(s.motion.duration_s() == doctest::Approx(40.0 / 60.0));
    check_near(s.motion.position(1.0 / 3.0), 20.0, 10.0);
    CHECK_FALSE(s.start_s.has_value());
    CHECK_FALSE(s.sound.carrier_hz.has_value());
    CHECK(one("path = \"M 0 10 H 40\"\nspeed_mm_s = 20").motion.duration_s() == doctest::Approx(2.0));
    CHECK(one("path = \"M 0 10 H 40\"\nduration_s = 3").motion.duration_s() == 3.0);
}

TEST_CASE("points are joined by straight lines")
{
    const stroke s = one("points = [[0, 0], [30, 0.0], [30, 40]]\nduration_s = 7");
    CHECK(s.motion.length_mm() == doctest::Approx(70.0));
    check_near(s.motion.position(3.0), 30.0, 0.0);
    check_near(s.motion.position(7.0), 30.0, 40.0);
}

TEST_CASE("an arc is clockwise on a screen")
{
    const stroke s = one(
        "arc = { centre = [20, 20], radius_mm = 16, from_deg = -90, sweep_deg = -180 }\nduration_s = 1.4");
    check_near(s.motion.position(0.0), 20.0, 4.0);
    check_near(s.motion.position(0.7), 4.0, 20.0);
    check_near(s.motion.position(1.4), 20.0, 36.0);
}

TEST_CASE("timed points keep their times, or are scaled in proportion")
{
    const std::string timed = "timed = [[0, 0, 0], [0.5, 10, 0, 0.5], [2, 10, 30, 0]]";
    const stroke s = one(timed);
    CHECK(s.motion.duration_s() == 2.0);
    check_near(s.motion.position(1.25), 10.0, 15.0);
    CHECK(s.motion.intensity(0.0) == 1.0);
    CHECK(s.motion.intensity(0.5) == doctest::Approx(0.5));
    const stroke slow = one(timed + "\nduration_s = 4\nintensity = 0.5");
    CHECK(slow.motion.duration_s() == 4.0);
    check_near(slow.motion.position(2.5), 10.0, 15.0);
    CHECK(slow.motion.intensity(1.0) == doctest::Approx(0.25));
    CHECK(one(timed + "\nspeed_mm_s = 10").motion.duration_s() == doctest::Approx(4.0));
}

TEST_CASE("a preset has its time, note and name, and can be changed")
{
    const stroke own = preset_stroke("park2016-3");
    const stroke s = one("preset = \"park2016-3\"");
    CHECK(s.name == "park2016-3");
    CHECK(s.note == own.note);
    CHECK(s.motion.duration_s() == own.motion.duration_s());
    CHECK(s.motion.intensity(1.0) == 1.0);
    const stroke t = one("preset = \"park2016-3\"\nname = \"slow\"\nduration_s = 3\nintensity = 0.25");
    CHECK(t.name == "slow");
    CHECK(t.motion.duration_s() == 3.0);
    CHECK(t.motion.intensity(1.0) == 0.25);
    for (const double part : {0.0, 0.3, 0.8, 1.0}) {
        const point p = own.motion.position(part * own.motion.duration_s());
        check_near(t.motion.position(part * 3.0), p.x_mm, p.y_mm);
    }
}

TEST_CASE("strokes have start, carrier, intensity and name")
{
    const std::vector<stroke> all = read(R"(
[[stroke]]
path = "M 0 0 H 40"
start_s = 0.5
[[stroke]]
name = "second"
path = "M 0 20 H 40"
carrier_hz = 200
intensity = 0.5
)");
    REQUIRE(all.size() == 2);
    CHECK(all[0].name == "wave-1");
    CHECK(all[0].start_s == 0.5);
    CHECK(all[1].name == "second");
    CHECK_FALSE(all[1].start_s.has_value());
    CHECK(all[1].sound.carrier_hz == 200.0);
    CHECK(all[1].motion.intensity(0.1) == 0.5);
}

TEST_CASE("a stroke has one geometry and one time")
{
    CHECK(complaint("duration_s = 1") ==
          "w.toml:1:1: [stroke] says nothing of what it is (add one of: path, points, timed, arc, preset)");
    CHECK(complaint("path = \"M 0 0 H 1\"\npreset = \"park2016-1\"") ==
          "w.toml:3:10: [stroke] has both path and preset (keep one of them)");
    CHECK(complaint("path = \"M 0 0 H 1\"\nduration_s = 1\nspeed_mm_s = 1") ==
          "w.toml:4:14: [stroke] has both duration_s and speed_mm_s (keep one of them)");
    CHECK(complaint("path = \"M 0 0 H 1\"\nduration = 1") ==
          "w.toml:3:1: unknown key 'duration' in [stroke] (did you mean 'duration_s'?)");
    CHECK(complaint("path = \"M 0 0 H 1\"\nspeed = 1").ends_with("(did you mean 'speed_mm_s'?)"));
}

TEST_CASE("values out of range are reported at the value")
{
    const std::string path = "path = \"M 0 0 H 1\"\n";
    CHECK(complaint(path + "duration_s = 0") ==
          "w.toml:3:14: duration_s is 0 (allowed: more than 0, at most 86400)");
    CHECK(complaint(path + "duration_s = nan").starts_with("w.toml:3:14: duration_s is nan"));
    CHECK(complaint(path + "speed_mm_s = -5").starts_with("w.toml:3:14: speed_mm_s is -5"));
    // A speed at which the stroke would take years.
    CHECK(complaint(path + "speed_mm_s = 1e-9").starts_with("w.toml:3:14: "));
    CHECK(complaint(path + "intensity = 1.5") == "w.toml:3:13: intensity is 1.5 (allowed: 0 to 1)");
    CHECK(complaint(path + "start_s = -1") == "w.toml:3:11: start_s is -1 (allowed: 0 to 86400)");
    CHECK(complaint(path + "carrier_hz = 0").starts_with("w.toml:3:14: carrier_hz is 0"));
    CHECK(complaint(path + "texture = \"weave\"") ==
          "w.toml:3:11: texture is 'weave' (known values: cycle, time, length)");
    CHECK(complaint(path + "texture_mm = 20") == "w.toml:3:14: [stroke] has texture_mm, which nothing uses "
                                                 "(add waveform = \"FILE.wav\" and texture = \"length\")");
    for (const texture_kind k : all_values<texture_kind>())
        CHECK(complaint(path + fmt::format("texture = \"{}\"", to_string(k))) ==
              "w.toml:3:11: [stroke] has texture, which nothing uses (add waveform = \"FILE.wav\")");
    CHECK(complaint(path + "name = 3") == "w.toml:3:8: name is 3 (give a string in quotes)");
    CHECK(complaint("path = 3") == "w.toml:2:8: path is 3 (give a string in quotes)");
}

TEST_CASE("refusals of geometry have their line")
{
    CHECK(complaint("\npath = \"M 0 0 X 1\"").starts_with("w.toml:3:8: "));
    CHECK(complaint("path = \"M 0 0 H 0\"").starts_with("w.toml:2:8: "));
    CHECK(complaint("preset = \"park2016-9\"").starts_with("w.toml:2:10: "));
    CHECK(complaint("points = [[1, 1], [1, 1]]").starts_with("w.toml:2:10: "));
    CHECK(complaint("points = []").starts_with("w.toml:2:10: "));
    CHECK(complaint("points = [[1, 1],\n[1, 2, 3]]") ==
          "w.toml:3:1: a point is a list (give a list of 2 numbers)");
    CHECK(complaint("points = [[1, 1],\n [1, inf]]") ==
          "w.toml:3:6: a point is inf (allowed: -1000000 to 1000000)");
    CHECK(complaint("points = \"1 1\"") == "w.toml:2:10: points is '1 1' (give a list of [x, y])");
    CHECK(complaint("arc = { centre = [0, 0], radius_mm = 0, from_deg = 0, sweep_deg = 90 }") ==
          "w.toml:2:38: radius_mm is 0 (allowed: more than 0, at most 1000000)");
    CHECK(complaint("arc = { center = [0, 0], radius_mm = 1, from_deg = 0, sweep_deg = 90 }") ==
          "w.toml:2:9: unknown key 'center' in arc (did you mean 'centre'?)");
    CHECK(complaint("arc = { centre = [0, 0], radius_mm = 1, from_deg = 0 }") ==
          "w.toml:2:7: arc has no sweep_deg (add sweep_deg = ...)");
    CHECK(complaint("arc = { centre = [0, 0], radius_mm = 1, from_deg = 0, sweep_deg = 361 }")
              .starts_with("w.toml:2:67: sweep_deg is 361"));
    CHECK(complaint("arc = { centre = [0, 0], radius_mm = 1, from_deg = 0, sweep_deg = 0 }")
              .starts_with("w.toml:2:7: "));
}

TEST_CASE("timed points are a recording, as lines of a CSV file are")
{
    const stroke s = one("timed = [\n[5, 0, 0, 51], [5, 1, 1, 255],\n[6, nan, 2],\n[7, 3, 3, 0]]", 255.0);
    CHECK(s.motion.duration_s() == 2.0);
    CHECK(s.motion.position(0.0) == tactor::point{1.0, 1.0});
    CHECK(s.motion.intensity(0.0) == 1.0);
    CHECK(s.motion.intensity(1.0) == 0.0);
    REQUIRE(s.warnings.size() == 2);
    CHECK(s.warnings[0] == "dir/wave.toml:4:1: no place (nan) in this point: the touch is lifted there");
    CHECK(s.warnings[1] == "dir/wave.toml:3:16: repeats the time of the point before, which does not count");
    CHECK(one("timed = [[0, 0, 0], [1, 1, 1]]\nintensity = 0.5", 255.0).motion.intensity(0.5) == 0.5);
}

TEST_CASE("timed points out of order are refused with the line of the point")
{
    CHECK(complaint("timed = [\n[0, 0, 0],\n[1, 1, 1],\n[0.5, 2, 2]]") ==
          "w.toml:5:2: time 0.5 s is before 1 s of the point before (times ascend)");
    CHECK(complaint("timed = [\n[0, 0]]") ==
          "w.toml:3:1: a timed point is a list (give [t_s, x_mm, y_mm] or [t_s, x_mm, y_mm, intensity])");
    CHECK(complaint("timed = [[0, 0, 0, -1], [1, 1, 1]]").starts_with("w.toml:2:20: intensity -1 ("));
    CHECK(complaint("timed = [[0, 0, 0, 1.5], [1, 1, 1]]")
              .starts_with("w.toml:2:20: intensity 1.5 is above 1"));
    CHECK(complaint("timed = [[0, 0, 0], [nan, 1, 1]]").starts_with("w.toml:2:22: t_s nan"));
    CHECK(complaint("timed = [[0, 0, 0]]").starts_with("w.toml:2:9: "));
    CHECK(complaint("timed = []").starts_with("w.toml:2:9: "));
    // A path of no length has no speed.
    CHECK(complaint("timed = [[0, 1, 1], [1, 1, 1]]").empty());
    CHECK(complaint("timed = [[0, 1, 1], [1, 1, 1]]\nspeed_mm_s = 5").starts_with("w.toml:3:14: "));
}

TEST_CASE("files without a stroke are refused")
{
    const auto whole = [](const std::string& text) {
        return caught_message([&] { static_cast<void>(parse_strokes_toml(text, "w.toml")); });
    };
    CHECK(whole("") == "w.toml: there is no stroke in it (add [stroke] or [[stroke]])");
    CHECK(whole("stroke = []\n").starts_with("w.toml:1:10: there is no stroke in it"));
    CHECK(whole("[strokes]\n") ==
          "w.toml:1:2: unknown key 'strokes' in a stroke file (did you mean 'stroke'?)");
    CHECK(whole("[array]\n") == "w.toml:1:1: this is an array or configuration file, not a stroke (give it "
                                "as array = FILE or config = FILE)");
    CHECK(whole("stroke = 3\n") == "w.toml:1:10: stroke is 3 (give [[stroke]] entries)");
    CHECK(whole("[[stroke]]\npath = \"M 0 0 H 1\"\n[[stroke]]\npat = 1\n") ==
          "w.toml:4:1: unknown key 'pat' in [[stroke]] (did you mean 'path'?)");
}

TEST_CASE("two hundred thousand timed points are read")
{
    std::string text = "timed = [\n";
    for (int i = 0; i < 200000; ++i)
        text += fmt::format("[{:.3f}, {}, 5],\n", i * 0.001, i % 40);
    const stroke s = one(text + "]");
    CHECK(s.motion.duration_s() == doctest::Approx(199.999));
    check_near(s.motion.position(0.007), 7.0, 5.0);
}

} // namespace stroke_toml_test
