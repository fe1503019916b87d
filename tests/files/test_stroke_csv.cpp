// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_csv_test {

using tactor::point;
using tactor::stroke;

namespace {

stroke one(const std::string& csv)
{
    std::vector<stroke> all = tactor::parse_strokes_csv(csv, "dir/finger.csv");
    REQUIRE(all.size() == 1);
    return all.front();
}

std::string refusal(const std::string& csv)
{
    return caught_message([&] { static_cast<void>(tactor::parse_strokes_csv(csv, "f.csv")); });
}

} // namespace

TEST_CASE("a CSV file is one stroke of timed points")
{
    const stroke s = one("t_s,x_mm,y_mm,intensity\n0,0,10,1\n0.5,20,20,0.5\n1.5,40,30,0\n");
    CHECK(s.name == "finger");
    CHECK_FALSE(s.start_s.has_value());
    CHECK(s.motion.duration_s() == 1.5);
    CHECK(s.motion.position(0.25) == point{10.0, 15.0});
    CHECK(s.motion.intensity(0.25) == 0.75);
    CHECK(s.note == tactor::note_kind::none);
}

TEST_CASE("columns come in any order, and intensity may be left out")
{
    const stroke s = one("y_mm,t_s,x_mm\n10,0,0\n30,2,40\n");
    CHECK(s.motion.position(1.0) == point{20.0, 20.0});
    CHECK(s.motion.intensity(1.0) == 1.0);
}

TEST_CASE("byte order mark, CRLF, blanks, quotes, comments and empty lines are accepted")
{
    const stroke s = one("\xEF\xBB\xBF# recorded\r\n\r\n \"t_s\" , x_mm,\ty_mm \r\n# begin\r\n 0 , \"0\" , "
                         "+10 \r\n\r\n  # end\r\n2.0e0,4e1, 30. \r\n");
    CHECK(s.motion.position(1.0) == point{20.0, 20.0});
    CHECK(one("t_s,x_mm,y_mm\n0,0,0\n1,1,1").motion.duration_s() == 1.0);
}

TEST_CASE("the time of the first line is the stroke's zero, for any clock of a recorder")
{
    for (const char* csv :
         {"t_s,x_mm,y_mm\n2.5,0,0\n3,5,0\n4.5,5,5\n", "t_s,x_mm,y_mm\n-2.5,0,0\n-2,5,0\n-0.5,5,5\n",
          "t_s,x_mm,y_mm\n1700000000.5,0,0\n1700000001,5,0\n1700000002.5,5,5\n",
          "y_mm,x_mm,t_s\n0,0,-0.5\n0,5,0\n5,5,1.5\n"}) {
        CAPTURE(csv);
        const stroke s = one(csv);
        CHECK_FALSE(s.start_s.has_value());
        CHECK(s.motion.duration_s() == 2.0);
        CHECK(s.motion.position(0.5) == point{5.0, 0.0});
    }
}

TEST_CASE("the last of lines with equal times counts, and the stroke has a note")
{
    const std::string head = "t_s,x_mm,y_mm,intensity\n";
    const stroke s = one(head + "2,9,9,1\n2,0,0,0.5\n# same report\n3,9,9,1\n3,8,8,1\n3,4,2,0\n4,8,8,1\n");
    CHECK(s.motion.duration_s() == 2.0);
    CHECK(s.motion.position(0.0) == point{0.0, 0.0});
    CHECK(s.motion.intensity(0.0) == 0.5);
    CHECK(s.motion.position(0.5) == point{2.0, 1.0});
    CHECK(s.motion.intensity(1.0) == 0.0);
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings[0] == "dir/finger.csv:3: repeats the time of the line before, as 3 lines do in all; the "
                           "last of equal times counts");

    const stroke last = one(head + "0,0,0,1\n1,4,4,1\n1,8,0,1\n");
    CHECK(last.motion.position(1.0) == point{8.0, 0.0});
    REQUIRE(last.warnings.size() == 1);
    CHECK(last.warnings[0] == "dir/finger.csv:4: repeats the time of the line before, which does not count");

    CHECK(one(head + "0,0,0,1\n1,1,1,1\n").warnings.empty());
}

TEST_CASE("faults of a CSV file are named by line and column")
{
    struct sample {
        const char* csv;
        const char* message;
    };
    const sample samples[] = {
        {"", "f.csv: is empty"},
        {"# only this\n\n", "f.csv:2: is empty"},
        {"t_s,x_mm,y_mm\n", "f.csv:1: 0 of at least 2 points"},
        {"t_s,x_mm,y_mm\n0,0,0\n", "f.csv:2: 1 of at least 2 points"},
        {"t_s,x_mm,z_mm\n", "f.csv:1:10: unknown column 'z_mm' (did you mean '"},
        {"t_s,x_mm,y_mm,intensty\n", "f.csv:1:15: unknown column 'intensty' (did you mean 'intensity'?)"},
        {"t_s,x_mm,y_mm,pupil\n0,0,0\n", "f.csv:2:5: 3 values where the header names 4 columns"},
        {"time,x,y\n0,0,0\n", "f.csv:1:6: unknown column 'x' (did you mean 'x_mm'?)"},
        {"0,0,0\n1,1,1\n", "f.csv:1:1: there is no line that names the columns (begin with: t_s,x_mm,y_mm)"},
        {"# finger\n0,0,0\n1,1,1\n", "f.csv:2:1: there is no line that names the columns"},
        {"\n# t_s,x_mm,y_mm\n0,0,0\n1,nan,1\n",
         "f.csv:2:1: the line that names the columns is a comment (take its # away; numpy.savetxt()"},
        {"t_s,x_mm,y_mm\r0,0,0\r1,1,1\r", "f.csv:1:14: its lines end in CR alone (save it"},
        {"# a\rt_s,x_mm,y_mm\r0,0,0\r", "f.csv:1:4: its lines end in CR alone"},
        {"t_s;x_mm;y_mm\n", "f.csv:1:1: semicolons separate its columns (separate them by commas"},
        {"0,5;1,0;2,0\n", "f.csv:1:1: semicolons separate its columns"},
        {"t_s\tx_mm\ty_mm\n", "f.csv:1:1: tabs separate its columns (separate them by commas: tr"},
        {"t_s x_mm y_mm\n0 1 2\n", "f.csv:1:1: blanks separate its columns (separate them by commas: tr -s"},
        {"  0.0  1.0  2.0\n", "f.csv:1:1: blanks separate its columns"},
        {"# t_s x_mm y_mm\n0 1 2\n", "f.csv:2:1: blanks separate its columns"},
        {"t_s,x_mm,t_s\n", "f.csv:1:10: column t_s twice"},
        {"\nt_s,x_mm\n", "f.csv:2: no column y_mm"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1\n", "f.csv:3:3: 2 values where the header names 3 columns"},
        {"t_s,x_mm,y_mm\n0,0,0\n0,5,1,1\n", "f.csv:3:5: 4 values where the header names 3 columns"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,,1\n",
         "f.csv:3:3: x_mm is missing (give a number, or nan where there is none)"},
        {"t_s,x_mm,y_mm\n0,0,0\n1, 1a,1\n", "f.csv:3:4: x_mm is not a number: '1a'"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,nan,1\n", "f.csv:3: 1 of at least 2 points"},
        {"t_s,x_mm,y_mm\n0,0,0\nnan,1,1\n", "f.csv:3:1: t_s is not a number: 'nan'"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1,inf\n", "f.csv:3:5: y_mm is not a number: 'inf'"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1,-1e999\n", "f.csv:3:5: y_mm -inf"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1000001,0\n", "f.csv:3:3: x_mm 1000001 (it is between -1e+06 and 1e+06)"},
        {"t_s,x_mm,y_mm\n0,0,0\n86401,1,0\n",
         "f.csv:3:1: time 86401 s is 86401 s after the first line (a stroke lasts at most 86400 s)"},
        {"t_s,x_mm,y_mm\n1000000,0,0\n1086400.5,1,0\n",
         "f.csv:3:1: time 1086400.5 s is 86400.5 s after the first line"},
        {"t_s,x_mm,y_mm\n0,0,0\n1e11,1,0\n", "f.csv:3:1: t_s 100000000000 (it is between -1e+10 and 1e+10)"},
        {"t_s,x_mm,y_mm\n-1,0,0\n-2,1,0\n", "f.csv:3:1: time -2 s is before -1 s"},
        {"t_s,x_mm,y_mm\n1e10,0,0\n10000000000.0000001,1,0\n",
         "f.csv:3: 1 of at least 2 points with times of their own"},
        {"t_s,x_mm,y_mm\n0,0,0\n1,1,0\n# x\n0.5,2,0\n",
         "f.csv:5:1: time 0.5 s is before 1 s of the line before (times ascend)"},
        {"x_mm,t_s,y_mm\n0,0,0\n1,2,0\n2,2,0\n2,1.5,0\n", "f.csv:5:3: time 1.5 s is before 2 s"},
        {"t_s,x_mm,y_mm\n7,0,0\n7,1,0\n7,2,0\n", "f.csv:4: 1 of at least 2 points with times of their own"},
        {"t_s,x_mm,y_mm,intensity\n0,0,0,1\n1,1,0,-0.5\n", "f.csv:3:7: intensity -0.5 (it is 0 or more)"},
        {"t_s,x_mm,y_mm,intensity\n0,0,0,1\n1,1,0,255\n",
         "f.csv:3:7: intensity 255 is above 1, which means the level asked for (say which value means 1: "
         "intensity_max = 100 for per cent, intensity_max = 127 for MIDI, intensity_max = 255 for 8 bits)"},
        {"t_ms,x_mm,y_mm\n", "f.csv:1:1: unknown column 't_ms' ('t_s' is in s, not ms: divide by 1000)"},
        {"t_s,x_cm,y_mm\n", "f.csv:1:5: unknown column 'x_cm' ('x_mm' is in mm, not cm: multiply by 10)"},
        {"t_s,x_mm,y_mm\n0,\"0,0\n", "f.csv:2:3: a quote that does not end"},
        {"t_s,x_mm,y_mm\n0,\"0\"0,0\n", "f.csv:2:6: text behind a quote"},
    };
    for (const sample& s : samples) {
        CAPTURE(s.csv);
        const std::string got = refusal(s.csv);
        CAPTURE(got);
        CHECK(got.find(s.message) == 0);
    }
}

TEST_CASE("columns that a tracker adds are ignored, with a note")
{
    const stroke s = one("frame,t_s,pupil,x_mm,note,y_mm\n7,0,n/a,0,\"a, b\",10\n8,1,,40,x,30\n");
    CHECK(s.motion.position(0.5) == point{20.0, 20.0});
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings[0] == "dir/finger.csv:1: these columns are left out: 'frame', 'pupil', 'note'");
    const stroke trailing = one("t_s,x_mm,y_mm,\n0,0,0,\n1,1,1,\n");
    REQUIRE(trailing.warnings.size() == 1);
    CHECK(trailing.warnings[0] == "dir/finger.csv:1: this column is left out: ''");
    CHECK(one("t_s,x_mm,y_mm,a,b,c,d,e,f\n0,0,0,,,,,,\n1,1,1,,,,,,\n").warnings.at(0) ==
          "dir/finger.csv:1: these columns are left out: 'a', 'b', 'c', 'd', 'e', ...");
}

TEST_CASE("lines without a place are gaps, in which the touch is lifted")
{
    for (const char* nan : {"nan", "NaN", "NAN", "NA"}) {
        const std::string lost = std::string(",") + nan + "," + nan + "\n";
        const stroke s = one("t_s,x_mm,y_mm\n5" + lost + "6,0,0\n7,10,0\n8" + lost + "9" + lost +
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
              "dir/finger.csv:2: no place (nan) in 4 lines from here on: the touch is lifted there");
    }
    const stroke half =
        one("t_s,x_mm,y_mm,intensity\n0,0,0,0.5\n1,1,nan,1\n2,4,0,0.5\n3,5,0,nan\n4,8,0,0.5\n");
    CHECK(half.motion.intensity(1.0) == 0.0);
    CHECK(half.motion.intensity(2.0) == 0.5);
    CHECK(half.motion.intensity(3.0) == 0.0);
    CHECK(half.motion.duration_s() == 4.0);
}

TEST_CASE("rows that a spreadsheet leaves empty are skipped")
{
    const stroke s = one("\n,,\nt_s,x_mm,y_mm\n0,5,5\n,,\n1,35,35\n,,\r\n , ,\n");
    CHECK(s.motion.duration_s() == 1.0);
    CHECK(s.motion.position(1.0) == point{35.0, 35.0});
    CHECK(s.warnings.empty());
}

TEST_CASE("the greatest intensity of a recorder's scale is 1")
{
    const auto read = [](double most) {
        return tactor::parse_strokes_csv("t_s,x_mm,y_mm,intensity\n0,0,0,255\n1,1,1,51\n", "f.csv", most);
    };
    CHECK(read(255.0).front().motion.intensity(0.0) == 1.0);
    CHECK(read(255.0).front().motion.intensity(1.0) == 0.2);
    CHECK(caught_message([&] {
              static_cast<void>(read(127.0));
          }).starts_with("f.csv:2:7: intensity 255 is above 127"));
    for (const double most : {0.0, -1.0, std::nan("")})
        CHECK(caught_message([&] { static_cast<void>(read(most)); }).starts_with("intensity_max: "));
}

TEST_CASE("a long stroke of few points is asked for its unit of time")
{
    const stroke s = one("t_s,x_mm,y_mm\n0,0,0\n3700,1,1\n7400,2,2\n");
    REQUIRE(s.warnings.size() == 1);
    CHECK(s.warnings[0] == "dir/finger.csv:4: only 3 points in 7400 s: times are in seconds; if these are "
                           "milliseconds, divide them by 1000");
    CHECK(one("t_s,x_mm,y_mm\n0,0,0\n3600,1,1\n").warnings.empty());
}

TEST_CASE("a million lines are read unchanged")
{
    std::string csv = "t_s,x_mm,y_mm\n";
    for (int i = 0; i < 1'000'000; ++i)
        csv += std::to_string(i) + "e-3," + std::to_string(i % 40) + "," + std::to_string(i % 17) + ".25\n";
    const stroke s = one(csv);
    CHECK(s.motion.duration_s() == doctest::Approx(999.999));
    CHECK(s.motion.position(123.456).x_mm == doctest::Approx(123456 % 40));
    CHECK(s.motion.position(123.456).y_mm == doctest::Approx(123456 % 17 + 0.25));
}

TEST_CASE("changed CSV gives a stroke or an error, nothing else")
{
    std::mt19937_64 random(555);
    const std::string good =
        "# a\nt_s,x_mm,y_mm,intensity\n0,0,10,1\n0.5,20,20,0.5\n\"1.5\",40,30,0\n2,1e1,-3.5,1\n";
    constexpr char letters[] = "0123456789.,-+eE\"#\n\r\t ;tsxym_\0\xff";
    const std::string alphabet(letters, sizeof letters - 1);
    std::uniform_int_distribution<std::size_t> letter(0, alphabet.size() - 1);
    int read = 0;
    for (int n = 0; n < 20000; ++n) {
        std::string csv = good;
        for (int change = 0; change < 1 + n % 5; ++change) {
            const std::size_t at = std::uniform_int_distribution<std::size_t>(0, csv.size() - 1)(random);
            if (n % 3 == 0)
                csv[at] = alphabet[letter(random)];
            else if (n % 3 == 1)
                csv.insert(at, 1, alphabet[letter(random)]);
            else
                csv.erase(at, 1 + n % 7);
        }
        CAPTURE(csv);
        const std::string m = refusal(csv);
        CHECK((m.empty() || m.find("f.csv") == 0));
        read += m.empty() ? 1 : 0;
    }
    CHECK(read > 500);
}

} // namespace stroke_csv_test
