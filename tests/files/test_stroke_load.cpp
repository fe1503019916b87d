// SPDX-License-Identifier: MIT
// Stroke files by their names, and the placing and movement of their strokes.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "files/stroke_format.hpp"
#include "folder.hpp"
#include "has.hpp"

namespace stroke_load_test {

using namespace tactor;

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
    return caught_message([&] { return tactor::load_strokes(file); });
}

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

const std::string line = "points = [[0, 10], [40, 10]]\n";

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

TEST_CASE("the extension gives the kind of a stroke file, in any case, and the text that of others")
{
    const folder f;
    for (const auto& [name, text] :
         {std::pair("a.csv", csv), std::pair("A.CSV", csv), std::pair("a.svg", svg),
          std::pair("a.toml", toml), std::pair("a.txt", csv), std::pair("a", svg), std::pair("b", toml)})
        CHECK(length(tactor::load_strokes(f.write(name, text))) == 6.0);
    CHECK(tactor::load_strokes(f.write("touch.csv", csv))[0].name == "touch");
    CHECK(refusal(f.write("b.csv", svg)).find("b.csv:1") != std::string::npos);
}

TEST_CASE("the kind of stroke text is guessed from its first line")
{
    CHECK(length(tactor::parse_strokes(csv, "-")) == 6.0);
    CHECK(length(tactor::parse_strokes("\xEF\xBB\xBF# t_s\n\n \"t_s\", x_mm, y_mm\n0,0,0\n1,6,0\n", "-")) ==
          6.0);
    CHECK(length(tactor::parse_strokes("\n  <?xml version='1.0'?>" + svg, "-")) == -1.0 + 7.0);
    CHECK(length(tactor::parse_strokes("# t_s\n" + toml, "-")) == 6.0);
    CHECK(caught_message([] {
              return tactor::parse_strokes("time,x,y\n", "-");
          }).find("-:1:6: unknown column 'x' (did you mean 'x_mm'?)") == 0);
    CHECK_FALSE(caught_message([] { return tactor::parse_strokes("", "-"); }).empty());
    CHECK_FALSE(caught_message([] { return tactor::parse_strokes("\xff\xfe", "-"); }).empty());
}

TEST_CASE("each format is told by its name, its extensions and what it writes")
{
    const folder f;
    const std::vector<stroke> one = parse_strokes(csv, "a");
    std::string titles;
    for (const detail::stroke_format* k : detail::stroke_formats()) {
        CAPTURE(k->name);
        CHECK(detail::find_format_by_name(k->name) == k);
        REQUIRE_FALSE(k->extensions.empty());
        CHECK(k->extensions.front() == "." + std::string(k->name)); // export writes it
        for (const std::string_view extension : k->extensions)
            CHECK(detail::find_format_by_extension(fmt::format("A{}", extension)) == k);
        CHECK(k->media_type.find('/') != k->media_type.npos);
        titles += fmt::format("{} ", k->title);
        if (k->write == nullptr)
            continue;
        const std::string text = k->write(one);
        const double mm = k->one_vibration ? 0.0 : 6.0;
        CHECK(detail::find_format_by_content(text) == k);
        CHECK(length(tactor::load_strokes(f.write(fmt::format("b{}", k->extensions.back()), text))) == mm);
        CHECK(length(tactor::parse_strokes(text, "-")) == mm);
    }
    CHECK(titles == "TOML CSV SVG TACT HAPTIC AHAP ");
    CHECK(detail::list_stroke_formats() == "TOML, CSV, SVG, TACT, HAPTIC or AHAP");
    CHECK(detail::find_format_by_name("json") == nullptr);
    CHECK(detail::find_format_by_extension("a.json") == nullptr);
    CHECK(detail::find_format_by_content("{\"plans\": []}") == nullptr); // plans
    CHECK(detail::find_stroke_format("{}", "a") ==
          detail::find_format_by_name("toml")); // says that it is JSON
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
        CHECK(
            said(name, heic)
                .find(": it is a HEIC or AVIF picture, not text (use TOML, CSV, SVG, TACT, HAPTIC or AHAP") ==
            0);
    CHECK(said("b.csv", std::string("\1\2\0\3\4,5", 7)).find(":1:1: it is binary, not text (") == 0);
    CHECK(said("c.svg", " \n").find(": it is empty (") == 0);
    CHECK(said("d.csv", svg).find(":1:1: it is SVG, or other XML (") == 0);
    CHECK(said("e.toml", csv).find(":1:1: it is a table (CSV) (") == 0);
    CHECK(said("f", "{\"plans\": []}").find(":1:1: it is JSON (") == 0);
}

TEST_CASE("numbers with units and decimal commas are named in TOML")
{
    const auto said = [](const std::string& line) {
        return caught_message([&] { return tactor::parse_strokes_toml("[stroke]\n" + line + "\n", "a"); });
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
    has(refusal(f.path() / "none.csv"), "none.csv: No such file or directory (check the name)");
    CHECK(refusal(f.path()).find(f.path().string() + ": it is a folder") == 0);
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
              return tactor::parse_strokes_csv(long_text, "x");
          }).find("x: it is larger than 512 MB") == 0);
    CHECK(caught_message([&] {
              return tactor::parse_strokes_svg(long_text, "x");
          }).find("x: it is larger than 48 MB") == 0);
}

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

TEST_CASE("faults of the keys that place a stroke have their place")
{
    const std::string line = "points = [[0, 0], [10, 0]]\n";
    const std::pair<const char*, std::vector<const char*>> all[] = {
        {"scale", {"0", "-1", "\"2\"", "nan"}},
        {"rotate_deg", {"4000", "[90]"}},
        {"translate_mm", {"3", "[1, 2, 3]", "[1e9, 0]"}},
        {"mirror", {"\"z\"", "true"}},
        {"about_mm", {"[1]"}},
    };
    for (const auto& [key, values] : all)
        for (const char* wrong : values) {
            const std::string why = complaint(line + fmt::format("{} = {}", key, wrong));
            CAPTURE(why);
            CHECK(why.find("w.toml:3:") == 0);
            has(why, key);
        }
    has(complaint(line + "rotate_deg_ = 1\n"), "did you mean 'rotate_deg'?");
    CHECK(complaint(line + "about_mm = [1, 2]").find("nothing is scaled") != std::string::npos);
    CHECK(complaint("points = [[0, 0], [1e6, 0]]\nscale = 10").find("w.toml:3:") == 0);
}

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

TEST_CASE("faults of easing, profiles and pauses have their place")
{
    const auto check_refused = [](const char* key, std::initializer_list<const char*> values) {
        for (const char* wrong : values) {
            const std::string why = complaint(line + fmt::format("{} = {}", key, wrong));
            CAPTURE(why);
            CHECK(why.find("w.toml:3:") == 0);
        }
    };
    check_refused("easing", {"\"fast\"", "3"});
    check_refused("speed_mm_s", {"[]", "[60]", "[[0, 60], [0, 30]]", "[[0.5, 60], [0.2, 30]]", "[[0, 0]]",
                                 "[[1.5, 60]]", "[[0, 1e-6]]", "\"fast\""});
    check_refused("intensity",
                  {"[[0, 1.5]]", "[[0, -1]]", "[[0, \"1\"]]", "[[nan, 1]]", "[[0, 1, 2]]", "{}"});
    check_refused("pauses",
                  {"0.5", "[]", "[0.5, 0.3]", "[[0.5]]", "[[0.5, 0]]", "[[0.5, 90000]]", "[[0.5, 86400]]",
                   "[[0.5, 0.3, 2]]", "[[0.5, 0.3, 1, 1]]", "[[-0.1, 0.3]]", "[[0.5, 0.3], [0.5, 0.3]]"});
    CHECK(complaint(line + "duration_s = 0.3\npauses = [[0.5, 0.3]]").find("w.toml:4:") == 0);
    has(complaint(line + "duration_s = 1.0\nspeed_mm_s = [[0, 1]]"), "has both duration_s and speed_mm_s");
    CHECK(complaint(line + "easing_ = 1").find("did you mean 'easing'?") != std::string::npos);
    CHECK(complaint(line + "pause = 1").find("did you mean 'pauses'?") != std::string::npos);
    for (const std::string key :
         {"easing = \"in-out\"", "pauses = [[0.5, 0.3]]", "intensity = [[0, 1]]", "speed_mm_s = [[0, 30]]"}) {
        const std::string why = complaint("timed = [[0, 0, 0], [1, 40, 0]]\n" + key);
        CHECK(why.find("w.toml:3:") == 0);
        CHECK(why.find("timed points have their own times") != std::string::npos);
    }
}

} // namespace stroke_load_test
