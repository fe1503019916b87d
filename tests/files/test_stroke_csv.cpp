// SPDX-License-Identifier: MIT
// Stroke files of CSV and TOML.
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "rounds.hpp"

namespace stroke_csv_test {

using namespace tactor;

namespace {

stroke recorded(const std::string& csv)
{
    std::vector<stroke> all = parse_strokes_csv(csv, "dir/finger.csv");
    REQUIRE(all.size() == 1);
    return all.front();
}

std::string refusal(const std::string& csv)
{
    return caught_message([&] { return parse_strokes_csv(csv, "f.csv"); });
}

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
    return caught_message([&] { return parse_strokes_toml("[stroke]\n" + body + "\n", "w.toml"); });
}

void check_near(point p, double x_mm, double y_mm)
{
    CHECK(distance_mm(p, {x_mm, y_mm}) < 1e-6);
}

} // namespace

TEST_CASE("a CSV file is one stroke of timed points")
{
    const stroke s = recorded("t_s,x_mm,y_mm,intensity\n0,0,10,1\n0.5,20,20,0.5\n1.5,40,30,0\n");
    CHECK(s.name == "finger");
    CHECK_FALSE(s.start_s.has_value());
    CHECK(s.motion.duration_s() == 1.5);
    CHECK(s.motion.position(0.25) == point{10.0, 15.0});
    CHECK(s.motion.intensity(0.25) == 0.75);
    CHECK(s.note == note_kind::none);
}

TEST_CASE("columns come in any order, and intensity may be left out")
{
    const stroke s = recorded("y_mm,t_s,x_mm\n10,0,0\n30,2,40\n");
    CHECK(s.motion.position(1.0) == point{20.0, 20.0});
    CHECK(s.motion.intensity(1.0) == 1.0);
}

TEST_CASE("byte order mark, CRLF, blanks, quotes, comments and empty lines are accepted")
{
    const stroke s =
        recorded("\xEF\xBB\xBF# recorded\r\n\r\n \"t_s\" , x_mm,\ty_mm \r\n# begin\r\n 0 , \"0\" , "
                 "+10 \r\n\r\n  # end\r\n2.0e0,4e1, 30. \r\n");
    CHECK(s.motion.position(1.0) == point{20.0, 20.0});
    CHECK(recorded("t_s,x_mm,y_mm\n0,0,0\n1,1,1").motion.duration_s() == 1.0);
}

TEST_CASE("the time of the first line is the stroke's zero, for any clock of a recorder")
{
    for (const char* csv :
         {"t_s,x_mm,y_mm\n2.5,0,0\n3,5,0\n4.5,5,5\n", "t_s,x_mm,y_mm\n-2.5,0,0\n-2,5,0\n-0.5,5,5\n",
          "t_s,x_mm,y_mm\n1700000000.5,0,0\n1700000001,5,0\n1700000002.5,5,5\n",
          "y_mm,x_mm,t_s\n0,0,-0.5\n0,5,0\n5,5,1.5\n"}) {
        CAPTURE(csv);
        const stroke s = recorded(csv);
        CHECK_FALSE(s.start_s.has_value());
        CHECK(s.motion.duration_s() == 2.0);
        CHECK(s.motion.position(0.5) == point{5.0, 0.0});
    }
}

TEST_CASE("the last of lines with equal times counts, and the stroke has a note")
{
    const std::string head = "t_s,x_mm,y_mm,intensity\n";
    const stroke s =
        recorded(head + "2,9,9,1\n2,0,0,0.5\n# same report\n3,9,9,1\n3,8,8,1\n3,4,2,0\n4,8,8,1\n");
    CHECK(s.motion.duration_s() == 2.0);
    CHECK(s.motion.position(0.0) == point{0.0, 0.0});
    CHECK(s.motion.intensity(0.0) == 0.5);
    CHECK(s.motion.position(0.5) == point{2.0, 1.0});
    CHECK(s.motion.intensity(1.0) == 0.0);
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings[0] == "dir/finger.csv:3: it has the same time as the previous line, and so do 3 lines "
                           "in all; only the last of equal times counts");

    const stroke last = recorded(head + "0,0,0,1\n1,4,4,1\n1,8,0,1\n");
    CHECK(last.motion.position(1.0) == point{8.0, 0.0});
    REQUIRE(last.warnings.size() == 1);
    CHECK(last.warnings[0] ==
          "dir/finger.csv:4: it has the same time as the previous line; only the last counts");

    CHECK(recorded(head + "0,0,0,1\n1,1,1,1\n").warnings.empty());
}

TEST_CASE("faults of a CSV file are named by line and column")
{
    const refused_text samples[] = {
        {"", "f.csv: it is empty"},
        {"# only this\n\n", "f.csv:2: it is empty"},
        {"t_s,x_mm,y_mm\n", "f.csv:1: a stroke needs at least 2 points, but this one has 0"},
        {"t_s,x_mm,y_mm\n0,0,0\n", "f.csv:2: a stroke needs at least 2 points, but this one has 1"},
        {"t_s,x_mm,z_mm\n", "f.csv:1:10: unknown column 'z_mm' (did you mean '"},
        {"t_s,x_mm,y_mm,intensty\n", "f.csv:1:15: unknown column 'intensty' (did you mean 'intensity'?)"},
        {"t_s,x_mm,y_mm,pupil\n0,0,0\n", "f.csv:2:5: 3 values, but the header names 4 columns"},
        {"time,x,y\n0,0,0\n", "f.csv:1:6: unknown column 'x' (did you mean 'x_mm'?)"},
        {"0,0,0\n1,1,1\n", "f.csv:1:1: no line names the columns (begin with: t_s,x_mm,y_mm)"},
        {"# finger\n0,0,0\n1,1,1\n", "f.csv:2:1: no line names the columns"},
        {"\n# t_s,x_mm,y_mm\n0,0,0\n1,nan,1\n", "f.csv:2:1: the line that names the columns is a comment "
                                                "(remove the # of this line; numpy.savetxt()"},
        {"t_s,x_mm,y_mm\r0,0,0\r1,1,1\r", "f.csv:1:14: its lines end in CR only (save it"},
        {"# a\rt_s,x_mm,y_mm\r0,0,0\r", "f.csv:1:4: its lines end in CR only"},
        {"t_s;x_mm;y_mm\n", "f.csv:1:1: semicolons separate its columns (separate them by commas"},
        {"0,5;1,0;2,0\n", "f.csv:1:1: semicolons separate its columns"},
        {"t_s\tx_mm\ty_mm\n", "f.csv:1:1: tabs separate its columns (separate them by commas: tr"},
        {"t_s x_mm y_mm\n0 1 2\n", "f.csv:1:1: blanks separate its columns (separate them by commas: tr -s"},
        {"  0.0  1.0  2.0\n", "f.csv:1:1: blanks separate its columns"},
        {"# t_s x_mm y_mm\n0 1 2\n", "f.csv:2:1: blanks separate its columns"},
        {"t_s,x_mm,t_s\n", "f.csv:1:10: the column t_s occurs twice"},
        {"\nt_s,x_mm\n", "f.csv:2: no column y_mm"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1\n", "f.csv:3:3: 2 values, but the header names 3 columns"},
        {"t_s,x_mm,y_mm\n0,0,0\n0,5,1,1\n", "f.csv:3:5: 4 values, but the header names 3 columns"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,,1\n", "f.csv:3:3: x_mm is missing (give a number, or nan for none)"},
        {"t_s,x_mm,y_mm\n0,0,0\n1, 1a,1\n", "f.csv:3:4: x_mm is not a number: '1a'"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,nan,1\n", "f.csv:3: a stroke needs at least 2 points, but this one has 1"},
        {"t_s,x_mm,y_mm\n0,0,0\nnan,1,1\n", "f.csv:3:1: t_s is not a number: 'nan'"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1,inf\n", "f.csv:3:5: y_mm is not a number: 'inf'"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1,-1e999\n", "f.csv:3:5: y_mm -inf"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1000001,0\n", "f.csv:3:3: x_mm 1000001 (give -1e+06 to 1e+06)"},
        {"t_s,x_mm,y_mm\n0,0,0\n86401,1,0\n",
         "f.csv:3:1: time 86401 s is 86401 s after the first line (use at most 86400 s)"},
        {"t_s,x_mm,y_mm\n1000000,0,0\n1086400.5,1,0\n",
         "f.csv:3:1: time 1086400.5 s is 86400.5 s after the first line"},
        {"t_s,x_mm,y_mm\n0,0,0\n1e11,1,0\n", "f.csv:3:1: t_s 100000000000 (give -1e+10 to 1e+10)"},
        {"t_s,x_mm,y_mm\n-1,0,0\n-2,1,0\n", "f.csv:3:1: time -2 s is before that of the previous line, -1 s"},
        {"t_s,x_mm,y_mm\n1e10,0,0\n10000000000.0000001,1,0\n",
         "f.csv:3: a stroke needs at least 2 points with different times, but this one has 1"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1,0\n# x\n0.5,2,0\n",
         "f.csv:5:1: time 0.5 s is before that of the previous line, 1 s (put times in ascending order)"},
        {"x_mm,t_s,y_mm\n0,0,0\n1,2,0\n2,2,0\n2,1.5,0\n",
         "f.csv:5:3: time 1.5 s is before that of the previous line, 2 s"},
        {"t_s,x_mm,y_mm\n7,0,0\n7,1,0\n7,2,0\n",
         "f.csv:4: a stroke needs at least 2 points with different times, but this one has 1"},
        {"t_s,x_mm,y_mm,intensity\n0,0,0,1\n1,1,0,-0.5\n",
         "f.csv:3:7: intensity -0.5 is below 0 (give 0 or more)"},
        {"t_s,x_mm,y_mm,intensity\n0,0,0,1\n1,1,0,255\n",
         "f.csv:3:7: intensity 255 is above 1, the requested level (name the value that means 1: "
         "intensity_max = 100 for per cent, intensity_max = 127 for MIDI, intensity_max = 255 for 8 bits)"},
        {"t_ms,x_mm,y_mm\n", "f.csv:1:1: unknown column 't_ms' ('t_s' is in s, not ms: divide by 1000)"},
        {"t_s,x_cm,y_mm\n", "f.csv:1:5: unknown column 'x_cm' ('x_mm' is in mm, not cm: multiply by 10)"},
        {"t_s,x_mm,y_mm\n0,\"0,0\n", "f.csv:2:3: a quote is not closed"},
        {"t_s,x_mm,y_mm\n0,\"0\"0,0\n", "f.csv:2:6: there is text after a quote"},
    };
    check_messages(samples, refusal);
}

TEST_CASE("columns that a tracker adds are ignored, with a note")
{
    const stroke s = recorded("frame,t_s,pupil,x_mm,note,y_mm\n7,0,n/a,0,\"a, b\",10\n8,1,,40,x,30\n");
    CHECK(s.motion.position(0.5) == point{20.0, 20.0});
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings[0] == "dir/finger.csv:1: these columns are left out: 'frame', 'pupil', 'note'");
    const stroke trailing = recorded("t_s,x_mm,y_mm,\n0,0,0,\n1,1,1,\n");
    REQUIRE(trailing.warnings.size() == 1);
    CHECK(trailing.warnings[0] == "dir/finger.csv:1: this column is left out: ''");
    CHECK(recorded("t_s,x_mm,y_mm,a,b,c,d,e,f\n0,0,0,,,,,,\n1,1,1,,,,,,\n").warnings.at(0) ==
          "dir/finger.csv:1: these columns are left out: 'a', 'b', 'c', 'd', 'e', ...");
}

TEST_CASE("lines without a place are gaps, in which the touch is lifted")
{
    for (const char* nan : {"nan", "NaN", "NAN", "NA"}) {
        const std::string lost = std::string(",") + nan + "," + nan + "\n";
        const stroke s = recorded("t_s,x_mm,y_mm\n5" + lost + "6,0,0\n7,10,0\n8" + lost + "9" + lost +
                                  "10,20,10\n11,30,10\n12" + lost);
        CHECK(s.motion.duration_s() == 5.0); // from the first place to the last
        CHECK(s.motion.position(1.0) == point{10.0, 0.0});
        CHECK(s.motion.position(4.0) == point{20.0, 10.0});
        for (const double t : {0.0, 0.5, 1.0, 4.0, 4.5, 5.0})
            CHECK(s.motion.intensity(t) == 1.0);
        for (const double t : {1.00001, 2.0, 3.0, 3.99999})
            CHECK(s.motion.intensity(t) == 0.0);
        REQUIRE(s.warnings.size() == 1);
        CHECK(s.warnings[0] ==
              "dir/finger.csv:2: no place (nan) in 4 lines from here on: the finger is lifted there");
    }
    const stroke half =
        recorded("t_s,x_mm,y_mm,intensity\n0,0,0,0.5\n1,1,nan,1\n2,4,0,0.5\n3,5,0,nan\n4,8,0,0.5\n");
    CHECK(half.motion.intensity(1.0) == 0.0);
    CHECK(half.motion.intensity(2.0) == 0.5);
    CHECK(half.motion.intensity(3.0) == 0.0);
    CHECK(half.motion.duration_s() == 4.0);
}

TEST_CASE("rows that a spreadsheet leaves empty are skipped")
{
    const stroke s = recorded("\n,,\nt_s,x_mm,y_mm\n0,5,5\n,,\n1,35,35\n,,\r\n , ,\n");
    CHECK(s.motion.duration_s() == 1.0);
    CHECK(s.motion.position(1.0) == point{35.0, 35.0});
    CHECK(s.warnings.empty());
}

TEST_CASE("the greatest intensity of a recorder's scale is 1")
{
    const auto read = [](double most) {
        return parse_strokes_csv("t_s,x_mm,y_mm,intensity\n0,0,0,255\n1,1,1,51\n", "f.csv", most);
    };
    CHECK(read(255.0).front().motion.intensity(0.0) == 1.0);
    CHECK(read(255.0).front().motion.intensity(1.0) == 0.2);
    CHECK(caught_message([&] { return read(127.0); }).starts_with("f.csv:2:7: intensity 255 is above 127"));
    for (const double most : {0.0, -1.0, std::nan("")})
        CHECK(caught_message([&] { return read(most); }).starts_with("intensity_max: "));
}

TEST_CASE("very many lines are read unchanged")
{
    const int lines = test::rounds(200'000, 1'000'000);
    std::string csv = "t_s,x_mm,y_mm\n";
    for (int i = 0; i < lines; ++i)
        csv += std::to_string(i) + "e-3," + std::to_string(i % 40) + "," + std::to_string(i % 17) + ".25\n";
    const stroke s = recorded(csv);
    CHECK(s.motion.duration_s() == doctest::Approx((lines - 1) * 1e-3));
    CHECK(s.motion.position(12.345).x_mm == doctest::Approx(12345 % 40));
    CHECK(s.motion.position(12.345).y_mm == doctest::Approx(12345 % 17 + 0.25));
}

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
          "w.toml:1:1: [stroke] is incomplete (add one of: path, points, timed, arc, preset)");
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
          "w.toml:3:14: duration_s is 0 (use more than 0, at most 86400)");
    CHECK(complaint(path + "duration_s = nan").starts_with("w.toml:3:14: duration_s is nan"));
    CHECK(complaint(path + "speed_mm_s = -5").starts_with("w.toml:3:14: speed_mm_s is -5"));
    // A speed at which the stroke would take years.
    CHECK(complaint(path + "speed_mm_s = 1e-9").starts_with("w.toml:3:14: "));
    CHECK(complaint(path + "intensity = 1.5") == "w.toml:3:13: intensity is 1.5 (use 0 to 1)");
    CHECK(complaint(path + "start_s = -1") == "w.toml:3:11: start_s is -1 (use 0 to 86400)");
    CHECK(complaint(path + "carrier_hz = 0").starts_with("w.toml:3:14: carrier_hz is 0"));
    CHECK(complaint(path + "texture = \"weave\"") ==
          "w.toml:3:11: texture is 'weave' (known values: cycle, time, length)");
    CHECK(complaint(path + "texture_mm = 20") == "w.toml:3:14: [stroke] has texture_mm, but nothing uses it "
                                                 "(add waveform = \"FILE.wav\" and texture = \"length\")");
    for (const texture_kind k : all_values<texture_kind>())
        CHECK(complaint(path + fmt::format("texture = \"{}\"", to_string(k))) ==
              "w.toml:3:11: [stroke] has texture, but nothing uses it (add waveform = \"FILE.wav\")");
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
    CHECK(complaint("points = [[1, 1],\n[1, 2, 3]]") == "w.toml:3:1: a point has 3 values (give 2 numbers)");
    CHECK(complaint("points = [[1, 1],\n [1, inf]]") ==
          "w.toml:3:6: a point is inf (use -1000000 to 1000000)");
    CHECK(complaint("points = \"1 1\"") == "w.toml:2:10: points is '1 1' (give a list of [x, y])");
    CHECK(complaint("arc = { centre = [0, 0], radius_mm = 0, from_deg = 0, sweep_deg = 90 }") ==
          "w.toml:2:38: radius_mm is 0 (use more than 0, at most 1000000)");
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
    CHECK(s.motion.position(0.0) == point{1.0, 1.0});
    CHECK(s.motion.intensity(0.0) == 1.0);
    CHECK(s.motion.intensity(1.0) == 0.0);
    REQUIRE(s.warnings.size() == 2);
    CHECK(s.warnings[0] == "dir/wave.toml:4:1: no place (nan) in this point: the finger is lifted there");
    CHECK(s.warnings[1] ==
          "dir/wave.toml:3:16: it has the same time as the previous point; only the last counts");
    CHECK(one("timed = [[0, 0, 0], [1, 1, 1]]\nintensity = 0.5", 255.0).motion.intensity(0.5) == 0.5);
}

TEST_CASE("timed points out of order are refused with the line of the point")
{
    CHECK(complaint("timed = [\n[0, 0, 0],\n[1, 1, 1],\n[0.5, 2, 2]]") ==
          "w.toml:5:2: time 0.5 s is before that of the previous point, 1 s (put times in ascending order)");
    CHECK(complaint("timed = [\n[0, 0]]") ==
          "w.toml:3:1: a timed point is a list (give [t_s, x_mm, y_mm] or [t_s, x_mm, y_mm, intensity])");
    CHECK(complaint("timed = [[0, 0, 0, -1], [1, 1, 1]]")
              .starts_with("w.toml:2:20: intensity -1 is below 0 ("));
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
        return caught_message([&] { return parse_strokes_toml(text, "w.toml"); });
    };
    CHECK(whole("") == "w.toml: it has no stroke (add [stroke] or [[stroke]])");
    CHECK(whole("stroke = []\n").starts_with("w.toml:1:10: it has no stroke"));
    CHECK(whole("[strokes]\n") ==
          "w.toml:1:2: unknown key 'strokes' in a stroke file (did you mean 'stroke'?)");
    CHECK(whole("[array]\n") == "w.toml:1:1: this is an array or configuration file, not a stroke (give it "
                                "as array = FILE or config = FILE)");
    CHECK(whole("stroke = 3\n") == "w.toml:1:10: stroke is 3 (give [[stroke]] entries)");
    CHECK(whole("[[stroke]]\npath = \"M 0 0 H 1\"\n[[stroke]]\npat = 1\n") ==
          "w.toml:4:1: unknown key 'pat' in [[stroke]] (did you mean 'path'?)");
}

} // namespace stroke_csv_test
