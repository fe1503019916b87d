// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <filesystem>
#include <random>
#include <string>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "folder.hpp"

namespace stroke_load_test {

namespace {

const std::string csv = "t_s,x_mm,y_mm\n0,0,0\n1,6,0\n";
const std::string svg = "<svg><line x2='6'/></svg>";
const std::string toml = "[stroke]\nname = \"t\"\npath = \"M 0 0 H 6\"\n";

double length(const std::vector<tactor::stroke>& strokes)
{
    return strokes.size() == 1 ? strokes[0].motion.length_mm() : -1.0;
}

std::string refusal(const std::filesystem::path& file)
{
    return caught_message([&] { static_cast<void>(tactor::load_strokes(file)); });
}

} // namespace

TEST_CASE("the extension gives the kind of a stroke file, in any case")
{
    const folder f;
    CHECK(length(tactor::load_strokes(f.write("a.csv", csv))) == 6.0);
    CHECK(length(tactor::load_strokes(f.write("A.CSV", csv))) == 6.0);
    CHECK(length(tactor::load_strokes(f.write("a.svg", svg))) == 6.0);
    CHECK(length(tactor::load_strokes(f.write("a.toml", toml))) == 6.0);
    CHECK(tactor::load_strokes(f.write("touch.csv", csv))[0].name == "touch");
    CHECK(refusal(f.write("b.csv", svg)).find("b.csv:1") != std::string::npos);
}

TEST_CASE("other extensions, or none, are guessed from the text")
{
    const folder f;
    CHECK(length(tactor::load_strokes(f.write("a.txt", csv))) == 6.0);
    CHECK(length(tactor::load_strokes(f.write("a", svg))) == 6.0);
    CHECK(length(tactor::load_strokes(f.write("b", toml))) == 6.0);
}

TEST_CASE("the kind of stroke text is guessed from its first line")
{
    CHECK(length(tactor::parse_strokes(csv, "-")) == 6.0);
    CHECK(length(tactor::parse_strokes("\xEF\xBB\xBF# t_s\n\n \"t_s\", x_mm, y_mm\n0,0,0\n1,6,0\n", "-")) ==
          6.0);
    CHECK(length(tactor::parse_strokes("\n  <?xml version='1.0'?>" + svg, "-")) == -1.0 + 7.0);
    CHECK(length(tactor::parse_strokes("# t_s\n" + toml, "-")) == 6.0);
    CHECK(caught_message([] {
              static_cast<void>(tactor::parse_strokes("time,x,y\n", "-"));
          }).find("-:1:6: unknown column 'x' (did you mean 'x_mm'?)") == 0);
    CHECK_FALSE(caught_message([] { static_cast<void>(tactor::parse_strokes("", "-")); }).empty());
    CHECK_FALSE(caught_message([] { static_cast<void>(tactor::parse_strokes("\xff\xfe", "-")); }).empty());
}

TEST_CASE("what is no stroke file is named for what it is")
{
    const folder f;
    const auto said = [&f](const std::string& name, std::string text) {
        return refusal(f.write(name, text)).substr((f.path() / name).string().size());
    };
    const std::string heic("\0\0\0\x18"
                           "ftypheic\0\0\0\0",
                           16);
    for (const char* name : {"a.csv", "a.svg", "a.toml", "a"})
        CHECK(said(name, heic).find(": is a HEIC or AVIF picture, not text (strokes are TOML, CSV or SVG") ==
              0);
    CHECK(said("b.csv", std::string("\1\2\0\3\4,5", 7)).find(":1:1: is binary, not text (") == 0);
    CHECK(said("c.svg", " \n").find(": is empty (") == 0);
    CHECK(said("d.csv", svg).find(":1:1: is SVG, or other XML (") == 0);
    CHECK(said("e.toml", csv).find(":1:1: is a table (CSV) (") == 0);
    CHECK(said("f", "{\"plans\": []}").find(":1:1: is JSON (") == 0);
}

TEST_CASE("numbers with units and decimal commas are named in TOML")
{
    const auto said = [](const std::string& line) {
        return caught_message(
            [&] { static_cast<void>(tactor::parse_strokes_toml("[stroke]\n" + line + "\n", "a")); });
    };
    CHECK(said("speed_mm_s = 2 cm") ==
          "a:2:14: '2 cm' is a number with a unit (give the number alone: its unit is in "
          "the name of the key, or in the manual)");
    CHECK(said("speed_mm_s = 20mm").find("a:2:14: '20mm' is a number with a unit") == 0);
    CHECK(said("points = [[0, 1 mm], [2, 3]]").find("a:2:15: '1 mm' is a number with a unit") == 0);
    CHECK(said("speed_mm_s = 20,0") == "a:2:14: '20,0' has a decimal comma (write 20.0)");
    CHECK(said("arc = { radius_mm = 20,5 }") == "a:2:21: '20,5' has a decimal comma (write 20.5)");
}

TEST_CASE("unreadable files are named")
{
    const folder f;
    CHECK(refusal(f.path() / "none.csv").find("none.csv: No such file or directory (check the name)") !=
          std::string::npos);
    CHECK(refusal(f.path()).find(f.path().string() + ": is a folder") == 0);
    if (::geteuid() != 0) {
        const auto secret = f.write("secret.csv", csv);
        std::filesystem::permissions(secret, std::filesystem::perms::none);
        CHECK(refusal(secret).find("Permission denied") != std::string::npos);
    }
}

TEST_CASE("text of gigabytes is refused before it is read")
{
    const std::string_view long_text(csv.data(), std::size_t{1} << 32);
    CHECK(caught_message([&] {
              static_cast<void>(tactor::parse_strokes_csv(long_text, "x"));
          }).find("x: longer than 512 MB") == 0);
    CHECK(caught_message([&] {
              static_cast<void>(tactor::parse_strokes_svg(long_text, "x"));
          }).find("x: longer than 48 MB") == 0);
}

TEST_CASE("random bytes are refused by every reader")
{
    std::mt19937_64 random(1);
    std::uniform_int_distribution<int> byte(0, 255);
    for (int n = 0; n < 5000; ++n) {
        std::string text(1 + static_cast<std::size_t>(n % 60), ' ');
        for (char& c : text)
            c = static_cast<char>(byte(random));
        CAPTURE(text);
        CHECK_FALSE(caught_message([&] { static_cast<void>(tactor::parse_strokes(text, "x")); }).empty());
        CHECK_FALSE(caught_message([&] { static_cast<void>(tactor::parse_strokes_csv(text, "x")); }).empty());
        CHECK_FALSE(caught_message([&] { static_cast<void>(tactor::parse_strokes_svg(text, "x")); }).empty());
        CHECK_FALSE(caught_message([&] { static_cast<void>(tactor::path::from_svg(text)); }).empty());
    }
}

} // namespace stroke_load_test
