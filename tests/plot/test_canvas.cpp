// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "plot/paint/canvas.hpp"

namespace canvas_test {

using namespace tactor::plot;

namespace {

double linear_light(std::uint8_t v) noexcept
{
    const double c = v / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// Returns relative luminance, 0 ... 1 (ITU-R BT.709 weights on linear light).
double luminance(colour c)
{
    return 0.2126 * linear_light(c.r) + 0.7152 * linear_light(c.g) + 0.0722 * linear_light(c.b);
}

} // namespace

TEST_CASE("text is as wide as the sum of its letters, and scales with its size")
{
    CHECK(text_width("", 10.0) == 0.0);
    CHECK(text_width("0", 10.0) == doctest::Approx(6.36));
    CHECK(text_width("00", 20.0) == doctest::Approx(25.44));
    CHECK(text_width("ii", 10.0) < text_width("WW", 10.0));
    CHECK(text_width("a", 10.0, true) > text_width("a", 10.0));
    CHECK(text_width("\xC3\xA9", 10.0) == doctest::Approx(10.0)); // one letter of two bytes
}

TEST_CASE("clean keeps text and replaces other bytes")
{
    CHECK(clean("Fingerkuppe \xC3\xA4\xE2\x82\xAC\xF0\x9F\x96\x90") ==
          "Fingerkuppe \xC3\xA4\xE2\x82\xAC\xF0\x9F\x96\x90");
    CHECK(clean("a\xFF"
                "b") == "a\xEF\xBF\xBD"
                        "b");
    CHECK(clean(std::string("a\0b", 3)) == "a\xEF\xBF\xBD"
                                           "b");
    CHECK(clean("\xC0\xAF") == "\xEF\xBF\xBD\xEF\xBF\xBD");         // too long a form
    CHECK(clean("\xED\xA0\x80").find('\xED') == std::string::npos); // half a pair
    CHECK(clean("\xE2\x82") == "\xEF\xBF\xBD\xEF\xBF\xBD");         // cut off
    CHECK(clean("a\tb\nc") == "a b c");
}

TEST_CASE("clean is idempotent for any bytes")
{
    std::mt19937_64 random(7);
    std::uniform_int_distribution<int> byte(0, 255);
    std::uniform_int_distribution<int> length(0, 40);
    for (int i = 0; i < 5000; ++i) {
        std::string s;
        for (int k = length(random); k > 0; --k)
            s += static_cast<char>(byte(random));
        const std::string once = clean(s);
        CHECK(clean(once) == once);
    }
}

TEST_CASE("shortened text fits, and shows that it was longer")
{
    CHECK(shorten("short", 6.0, 100.0) == "short");
    const std::string all = "a name that is far too long for the place that it has";
    for (double w = 10.0; w < 200.0; w += 3.0) {
        const std::string s = shorten(all, 6.0, w);
        CHECK(text_width(s, 6.0) <= w);
        if (s != all)
            CHECK(s.ends_with("\xE2\x80\xA6"));
    }
    CHECK(text_width(shorten(std::string(1 << 20, 'x'), 6.0, 80.0), 6.0) <= 80.0);
}

TEST_CASE("shortened text keeps its beginning, its end or both")
{
    const std::string all = "\xC3\xA4 first part and a last one\xC3\xB6";
    for (double w = 20.0; w < text_width(all, 6.0); w += 2.0)
        for (const double end : {0.0, 0.5, 1.0}) {
            const std::string s = shorten(all, 6.0, w, false, end);
            CHECK(text_width(s, 6.0) <= w);
            const std::size_t cut = s.find("\xE2\x80\xA6");
            REQUIRE(cut != std::string::npos);
            CHECK(all.starts_with(s.substr(0, cut)));
            CHECK(all.ends_with(s.substr(cut + 3)));
            CHECK((cut + 3 == s.size()) == (end == 0.0));
            if (end == 0.5)
                CHECK(cut > 0);
            CHECK(clean(s) == s); // no character is cut
        }
}

TEST_CASE("a shortened title keeps its unit and its numbers")
{
    const std::string title = "constant error of the speed of a stroke (mm/s)";
    CHECK(shorten_title(title, 6.5, 1e3) == title);
    for (double w = 60.0; w < text_width(title, 6.5); w += 5.0) {
        const std::string s = shorten_title(title, 6.5, w);
        CHECK(text_width(s, 6.5) <= w);
        CHECK(s.starts_with("con"));
        CHECK(s.ends_with(" (mm/s)"));
    }
    CHECK(text_width(shorten_title("a (" + std::string(99, 'x') + ")", 6.5, 50.0), 6.5) <= 50.0);
    CHECK(shorten_title("a long name without a unit)", 6.5, 60.0).ends_with("unit)"));
}

TEST_CASE("names that differ still differ when they are shortened")
{
    const std::vector<std::string> late{"continuous-150-hz", "continuous-250-hz", "continuous-200-hz"};
    std::vector<std::string> both{"all"};
    for (const std::string& method : late)
        for (const char* motion : {"from-left-to-right", "from-left-to-centre"})
            both.push_back(method + ":" + motion);
    const std::vector<std::string> middle{"x-a-middle-part-with-the-same-length-x",
                                          "x-a-middle-past-with-the-same-length-x"};
    for (const auto& names : {late, both, middle}) {
        const auto s = shorten_names(names, 6.0, 40.0, 100.0);
        REQUIRE(s.size() == names.size());
        CHECK(std::set(s.begin(), s.end()).size() == s.size());
        for (const std::string& name : s)
            CHECK(text_width(name, 6.0) <= 100.0);
    }
    CHECK(text_width(shorten_names(late, 6.0, 40.0, 100.0)[0], 6.0) <= 40.0);
    CHECK(shorten_names({"across", "down:left"}, 6.0, 40.0, 100.0) ==
          std::vector<std::string>{"across", "down:left"});
    // No width that is allowed shows where these differ.
    const std::string much(99, 'x');
    const auto same = shorten_names({much + "1" + much, much + "2" + much}, 6.0, 40.0, 100.0);
    CHECK(text_width(same[1], 6.0) <= 100.0);
}

TEST_CASE("lines do not break between a number and its unit")
{
    const std::string text = "noise of 60 to 400 Hz, then silence";
    for (double w = text_width("400 Hz,", 6.0) + 0.01; w < 150.0; w += 1.0) {
        const auto lines = wrap(text, 6.0, w, 9);
        for (std::size_t i = 1; i < lines.size(); ++i)
            CHECK((lines[i - 1].find("Hz") != std::string::npos || !lines[i].starts_with("Hz")));
        std::string all = lines[0];
        for (std::size_t i = 1; i < lines.size(); ++i)
            all += " " + lines[i];
        CHECK(all == text);
    }
}

TEST_CASE("lines break between words, and one too many is shortened")
{
    const auto lines = wrap("one, two,  three", 6.0, text_width("one, two,", 6.0) + 0.01, 3);
    CHECK(lines == std::vector<std::string>{"one, two,", "three"});
    CHECK(wrap("", 6.0, 1e9, 3).empty());
    const auto cut = wrap("one two three", 6.0, text_width("three", 6.0), 2);
    REQUIRE(cut.size() == 2);
    CHECK(cut[1].ends_with("\xE2\x80\xA6"));
}

TEST_CASE("numbers have no noise")
{
    CHECK(number(0.07) == "0.07");
    CHECK(number(0.1 + 0.2) == "0.3");
    CHECK(number(-0.0) == "0");
    CHECK(number(75.398223686) == "75.4");
    CHECK(number(3600.0, 6) == "3600");
}

TEST_CASE("the colours of time get steadily lighter, so that they are in order in grey too")
{
    double before = luminance(map_to_colour(0.0));
    for (int i = 1; i <= 1000; ++i) {
        const double now = luminance(map_to_colour(i / 1000.0));
        CHECK(now >= before - 0.002); // steps of 8-bit colours
        before = now;
    }
    // Evenly: a tenth of the map is never lost.
    for (int i = 0; i < 10; ++i)
        CHECK(std::sqrt(luminance(map_to_colour((i + 1) / 10.0))) -
                  std::sqrt(luminance(map_to_colour(i / 10.0))) >
              0.04);
}

TEST_CASE("the lightest colour of time is visible on white")
{
    const double contrast = 1.05 / (luminance(map_to_colour(1.0)) + 0.05);
    CHECK(contrast > 1.4);
    CHECK(luminance(map_to_colour(0.0)) < 0.02);
}

TEST_CASE("a value out of range has the nearest colour")
{
    CHECK(map_to_colour(-3.0) == map_to_colour(0.0));
    CHECK(map_to_colour(7.0) == map_to_colour(1.0));
    CHECK(map_to_colour(std::numeric_limits<double>::quiet_NaN()) == map_to_colour(0.0));
    CHECK(map_to_colour(std::numeric_limits<double>::infinity()) == map_to_colour(0.0));
}

TEST_CASE("colours of strokes differ, are visible on white, and repeat")
{
    for (std::size_t i = 0; i < stroke_colours; ++i) {
        CHECK(luminance(stroke_colour(i)) < 0.6);
        for (std::size_t k = 0; k < i; ++k)
            CHECK(stroke_colour(i) != stroke_colour(k));
    }
    CHECK(stroke_colour(stroke_colours) == stroke_colour(0));
}

TEST_CASE("colours of lines differ in lightness")
{
    CHECK(std::abs(luminance(blue) - luminance(orange)) > 0.15);
    CHECK(std::abs(luminance(orange) - luminance(vermilion)) > 0.15);
    CHECK(std::abs(luminance(blue) - luminance(vermilion)) > 0.05);
}

} // namespace canvas_test
