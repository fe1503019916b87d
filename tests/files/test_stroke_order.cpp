// SPDX-License-Identifier: MIT
// Keys of a stroke file that repeat, group and start strokes, play them backwards and plan each in another
// way.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
#include "has.hpp"

namespace stroke_order_test {

using namespace tactor;

namespace {

/// Returns TOML of a stroke along a line with this duration.
std::string line(double seconds, const std::string& keys = "")
{
    return fmt::format("points = [[0, 0], [40, 0]]\nduration_s = {}\n{}\n", seconds, keys);
}

std::vector<stroke> parse_all(const std::string& text)
{
    return parse_strokes_toml(text, "p.toml");
}

/// Returns the start of each stroke, if each takes the time of its movement.
std::vector<double> starts(const std::string& text)
{
    std::vector<double> from;
    std::vector<double> to;
    for (const stroke& s : parse_all(text)) {
        from.push_back(resolve_start_s(s.start_s, s.anchor, from, to));
        to.push_back(from.back() + s.motion.duration_s());
    }
    return from;
}

void check_starts(const std::string& text, const std::vector<double>& wanted)
{
    CAPTURE(text);
    const std::vector<double> found = starts(text);
    REQUIRE(found.size() == wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        CHECK(found[i] == doctest::Approx(wanted[i]).epsilon(1e-12));
}

std::string complaint(const std::string& text)
{
    return caught_message([&] { parse_all(text); });
}

const std::string one = "[[stroke]]\n";
const std::string inside = "[[stroke.stroke]]\n";

} // namespace

TEST_CASE("a stroke chooses its faces")
{
    const std::string text = "[stroke]\npath = \"M 0 0 L 40 0\"\nfaces = ";
    const stroke s = parse_strokes_toml(text + "\"nearest\"\n", "t").front();
    CHECK(s.choices == stroke_choices{.faces = faces_kind::nearest});
    CHECK(parse_strokes_toml(detail::stroke_text(s), "t").front().choices == s.choices);
    has(caught_message([&] { return parse_strokes_toml(text + "\"neerest\"\n", "t"); }), "t:3:9: faces");
}

TEST_CASE("starts count from the piece, from the start of the one before, or from its end")
{
    check_starts(one + line(1) + one + line(2), {0.0, 1.0});
    check_starts(one + line(1) + one + line(2, "start_s = 0.3"), {0.0, 0.3});
    check_starts(one + line(1, "start_s = 5") + one + line(2, "start_s = 0.3\nstart_from = \"start\"") + one +
                     line(1),
                 {5.0, 5.3, 7.3});
    check_starts(one + line(1) + one + line(2, "start_s = 0.3\nstart_from = \"end\""), {0.0, 1.3});
    check_starts(one + line(1) + one + line(2, "start_s = -0.3\nstart_from = \"end\""), {0.0, 0.7});
    check_starts(one + line(1, "start_s = 2") + one + line(2, "start_from = \"start\""), {2.0, 2.0});
    check_starts(one + line(1, "start_s = 2") + one + line(2, "start_from = \"piece\""), {2.0, 0.0});
    check_starts(one + line(1, "start_s = 2\nstart_from = \"end\"") + one + line(1), {2.0, 3.0});
    // Equal to the bit and to the frame.
    const auto s = parse_all(one + line(1, "start_s = 0.1") + one + line(2, "start_s = 0.3") + one + line(1) +
                             one + line(1, "start_from = \"end\""));
    CHECK(s[1].start_s == 0.3);
    CHECK(s[1].anchor == start_anchor{});
    CHECK_FALSE(s[2].start_s.has_value());
    CHECK_FALSE(s[3].start_s.has_value());
    CHECK_FALSE(parse_all("[stroke]\n" + line(1))[0].start_s.has_value());
    CHECK(parse_all("[stroke]\nstart_s = 0.25\n" + line(1))[0].start_s == 0.25);
}

TEST_CASE("a start before the piece is refused once it is known")
{
    const auto s = parse_all(one + line(1) + one + line(2, "start_s = -1.5\nstart_from = \"end\""));
    const std::vector<double> from{0.0};
    const std::vector<double> to{1.0};
    CHECK(caught_message([&] { return resolve_start_s(s[1].start_s, s[1].anchor, from, to); }) ==
          "start of the stroke: 1.5 s before the end of the previous stroke is before the start of the "
          "piece (give at most 1 s before that end)");
    CHECK(s[1].places.start.line != 0); // where the file has it
    CHECK(s[0].places.start.line == 0);
}

TEST_CASE("a stroke is repeated with pauses, and the next ones come after all")
{
    check_starts(one + line(1, "repeat = 3\npause_s = 0.5") + one + line(1), {0.0, 1.5, 3.0, 4.0});
    check_starts(one + line(1, "repeat = 2\nstart_s = 2") + one +
                     line(1, "start_s = 0.1\nstart_from = \"start\""),
                 {2.0, 3.0, 2.1});
    const auto s = parse_all(one + line(1, "repeat = 2\nname = \"knock\""));
    CHECK(s[0].name == "knock (1 of 2)");
    CHECK(s[1].name == "knock (2 of 2)");
    CHECK_FALSE(s[1].start_s.has_value());
    CHECK(parse_all(one + line(1, "repeat = 1"))[0].name == "p-1");
}

TEST_CASE("groups repeat as a whole, and their strokes count from their start")
{
    const std::string group = one + "repeat = 2\npause_s = 0.5\nstart_s = 1\n" + inside + line(1) + inside +
                              line(3, "start_s = 0.25");
    // The group lasts 3.25 s; the next stroke comes when the last of it has ended.
    check_starts(group + one + line(1), {1.0, 1.25, 4.75, 5.0, 8.0});
    check_starts(group + one + line(1, "start_from = \"start\""), {1.0, 1.25, 4.75, 5.0, 1.0});
    // Its first stroke begins later than the group.
    check_starts(one + line(1) + one + "repeat = 2\n" + inside + line(1, "start_s = 0.5") + inside +
                     line(1, "start_s = 0.25"),
                 {0.0, 1.5, 1.25, 3.0, 2.75});
    // Groups in groups.
    check_starts(one + "repeat = 2\n" + inside + line(1) + inside +
                     "repeat = 2\npause_s = 0.1\n[[stroke.stroke.stroke]]\n" + line(0.2),
                 {0.0, 1.0, 1.3, 1.5, 2.5, 2.8});
}

TEST_CASE("a group's keys hold for all its strokes")
{
    const auto s =
        parse_all(one + "name = \"pair\"\nscale = 0.5\ntranslate_mm = [1, 2]\nlevel_db = -20\n" + inside +
                  line(1, "translate_mm = [2, 0]") + inside + line(1, "level_db = -20\nname = \"weak\""));
    REQUIRE(s.size() == 2);
    CHECK(s[0].name == "pair-1");
    CHECK(s[1].name == "weak");
    CHECK(s[0].motion.position(1.0) == point{22.0, 2.0});
    CHECK(s[1].motion.position(1.0) == point{21.0, 2.0});
    CHECK(s[0].choices.level_db == -20.0);
    CHECK(s[1].choices.level_db == -40.0);
    CHECK(s[1].motion.intensity(0.5) == 1.0);
}

TEST_CASE("a reversed stroke goes from its end to its start, with its profile")
{
    const stroke s = parse_all(one + line(1, "reverse = true\nintensity = [[0, 0.2], [1, 1]]"))[0];
    CHECK(s.motion.position(0.0) == point{40.0, 0.0});
    CHECK(s.motion.intensity(0.0) == doctest::Approx(1.0));
    CHECK(s.motion.intensity(1.0) == doctest::Approx(0.2));
    CHECK(parse_all(one + "timed = [[0, 1, 1, 0.5], [1, 9, 1]]\nreverse = true")[0].motion.position(1.0) ==
          point{1.0, 1.0});
    CHECK(parse_all(one + line(1, "reverse = false"))[0].motion.position(0.0) == point{0.0, 0.0});
}

TEST_CASE("a reversed stroke has the same carrier at each place")
{
    const std::string rising = "carrier_profile = [[0, 100], [0.25, 300]]\n";
    CHECK(parse_all(one + line(1, rising))[0].sound.carrier_profile ==
          std::vector<carrier_part>{{0.0, 100.0}, {0.25, 300.0}});
    CHECK(parse_all(one + line(1, rising + "reverse = true"))[0].sound.carrier_profile ==
          std::vector<carrier_part>{{0.75, 300.0}, {1.0, 100.0}});
}

TEST_CASE("a stroke may be planned in its own way")
{
    const stroke s =
        parse_all(one + line(1, "algorithm = \"tactile-brush\"\nphantom = \"barycentric\"\nsoa_s = 0.06\n"
                                "burst_s = 0.05\nfit = true\nfit_margin_mm = 2"))[0];
    CHECK(s.choices == stroke_choices{algorithm_kind::tactile_brush, phantom_kind::barycentric, 0.06, 0.05});
    CHECK(s.fit == stroke_fit{2.0});
    CHECK(parse_all(one + line(1, "fit = true"))[0].fit == stroke_fit{});
    CHECK(parse_all(one + line(1))[0].choices == stroke_choices{});
    for (const algorithm_kind k : all_values<algorithm_kind>())
        CHECK(
            parse_all(one + line(1, fmt::format("algorithm = \"{}\"", to_string(k))))[0].choices.algorithm ==
            k);
}

TEST_CASE("a group is fitted together")
{
    const std::string two = "[[stroke.stroke]]\npath = \"M 0 0 L 10 0\"\nduration_s = 0.5\n"
                            "[[stroke.stroke]]\npath = \"M 0 10 L 10 10\"\nduration_s = 0.5\n";
    const std::vector<stroke> asked =
        parse_all("[[stroke]]\nfit = true\nfit_margin_mm = 5\n" + two + "[[stroke]]\nfit = true\n" + two);
    REQUIRE(asked.size() == 4);
    CHECK(asked[0].fit->group == asked[1].fit->group);
    CHECK(asked[2].fit->group == asked[3].fit->group);
    CHECK(asked[0].fit->group != asked[2].fit->group);
    CHECK(asked[0].fit->margin_mm == 5.0);
    CHECK(asked[3].fit->margin_mm == 0.0);
    const std::string inside = "{fit = true, stroke = [{path = 'M 0 0 H 10'}]}";
    const std::vector<stroke> on_one_line = parse_all("stroke = [" + inside + ", " + inside + "]\n");
    REQUIRE(on_one_line.size() == 2);
    CHECK(on_one_line[0].fit->group != on_one_line[1].fit->group);
    const std::vector<stroke> of_another_file = parse_strokes_toml("stroke = [" + inside + "]", "b.toml");
    CHECK(of_another_file[0].fit->group != on_one_line[0].fit->group);
    CHECK_FALSE(parse_all("[[stroke]]\n" + two)[0].fit);
    has(complaint("[[stroke]]\nfit = true\n" + two + "fit = true\n"), "is in a group that is fitted");
    CHECK(complaint("[[stroke]]\nfit_margin_mm = 1\n" + two).find("nothing is fitted") != std::string::npos);
}

TEST_CASE("their faults have their place")
{
    // `before` are keys that the wrong one needs.
    const auto check_refused = [](const std::string& key, std::initializer_list<const char*> values,
                                  const std::string& before = "") {
        for (const char* wrong : values) {
            const std::string why =
                complaint(one + line(1) + one + line(1, before + fmt::format("{} = {}", key, wrong)));
            CAPTURE(key);
            CAPTURE(why);
            CHECK(why.find(before.empty() ? "p.toml:8:" : "p.toml:9:") == 0);
        }
    };
    check_refused("repeat", {"0", "1.5", "10001", "\"2\""});
    check_refused("pause_s", {"0.5"});
    check_refused("pause_s", {"-1", "\"1\""}, "repeat = 2\n");
    check_refused("start_s", {"-1", "nan"});
    check_refused("start_from", {"\"before\"", "1"});
    check_refused("start_s", {"-90000"}, "start_from = \"end\"\n");
    check_refused("reverse", {"1"});
    check_refused("algorithm", {"\"park\"", "1"});
    check_refused("phantom", {"\"baricentric\""});
    check_refused("soa_s", {"0", "11"});
    check_refused("burst_s", {"0", "\"1\""});
    check_refused("burst_s", {"0.06"}, "soa_s = 0.05\n");
    check_refused("level_db", {"0.01", "28", "-121", "\"1\""});
    check_refused("fit", {"1"});
    check_refused("fit_margin_mm", {"2"});
    check_refused("fit_margin_mm", {"-1"}, "fit = true\n");
    check_refused("stroke", {"[1]"});
    check_refused("repeats", {"2"});
    check_refused("level_dbfs", {"-6"});
    CHECK(complaint(one + "stroke = []").find("p.toml:2:") == 0);
    has(complaint(one + "speed_mm_s = 30\n" + inside + line(1)), "unknown key 'speed_mm_s'");
    CHECK(complaint(one + line(1) + inside + line(1)).find("has both") != std::string::npos);
    has(complaint(one + "repeat = 1000\n" + inside + line(1, "repeat = 1000")), "strokes in all");
    std::string deep = "points = [[0, 0], [1, 0]]";
    for (int i = 0; i < 9; ++i)
        deep = "stroke = [{ " + deep + " }]";
    has(complaint(one + deep), "groups are nested too deep");
}

} // namespace stroke_order_test
