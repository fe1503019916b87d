// SPDX-License-Identifier: MIT
// [array] and [[tactor]] of a file, and their faults.
#include <doctest/doctest.h>

#include <string>

#include <fmt/format.h>

#include <tactor/setup.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"

namespace setup_array_test {

using namespace tactor;

namespace {

std::string complaint(const std::string& text)
{
    return caught_message([&] { static_cast<void>(parse_setup(text, "palm.toml")); });
}

array parse_array(const std::string& text)
{
    const setup s = parse_setup(text, "palm.toml");
    REQUIRE(s.array.has_value());
    return *s.array;
}

const std::string grid = "[array]\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n";

} // namespace

TEST_CASE("a grid has one pitch, or two")
{
    const array a =
        parse_array("[array]\nname = \"mine\"\ngrid = { rows = 3, columns = 3, pitch_mm = 20 }\n");
    CHECK(a.name == "mine");
    const array b = preset_array("palm-3x3");
    for (unsigned i = 0; i < 9; ++i)
        CHECK(a.tactors[i].position == b.tactors[i].position);
    CHECK(a.where.text() == "palm.toml:1:1");

    const array c = parse_array("[array]\ngrid = { rows = 2, columns = 2, pitch_mm = [20.0, 40.0] }\n");
    CHECK(c.name == "palm");
    CHECK(c.tactors[3].position == point{20.0, 40.0});
}

TEST_CASE("an array is mirrored and turned about its middle")
{
    const array upside_down =
        parse_array("[array]\ngrid = { rows = 2, columns = 3, pitch_mm = 20 }\nrotate_deg = 180\n");
    CHECK(upside_down.tactors[0].position == point{40.0, 20.0});
    CHECK(upside_down.tactors[0].channel == 0);
    CHECK(upside_down.tactors[5].position == point{0.0, 0.0});

    const array left = parse_array("[array]\npreset = \"palm-3x3\"\nmirror = \"x\"\n");
    CHECK(left.tactors[0].position == point{40.0, 0.0});
    CHECK(left.tactors[6].position == point{40.0, 40.0});

    // Mirrored first, then turned clockwise on a screen.
    const array both = parse_array("[array]\npreset = \"palm-3x3\"\nmirror = \"x\"\nrotate_deg = 90\n");
    CHECK(both.tactors[0].position == point{40.0, 40.0});
    CHECK(both.tactors[2].position == point{40.0, 0.0});

    CHECK(complaint("[array]\npreset = \"palm-3x3\"\nmirror = \"z\"\n").find("palm.toml:3") !=
          std::string::npos);
}

TEST_CASE("a list of tactors has every key, and defaults")
{
    const array a = parse_array(R"(
[array]
actuator = "piezo"
[[tactor]]
x_mm = 1.5
y_mm = -2
[[tactor]]
x_mm = 20.0
y_mm = 0.0
channel = 7
gain_db = -3.5
max_dbfs = -3
threshold_dbfs = -41.5
polarity = -1
actuator = "voice-coil"
)");
    REQUIRE(a.tactors.size() == 2);
    const tactor_spec& t = a.tactors[0];
    CHECK(t.position == point{1.5, -2.0});
    CHECK(t.channel == 0);
    CHECK(t.max_dbfs == 0.0);
    CHECK(t.polarity == 1);
    CHECK(t.actuator == actuator_kind::piezo);
    CHECK(t.where.text() == "palm.toml:4:1");
    const tactor_spec& u = a.tactors[1];
    CHECK(u.channel == 7);
    CHECK(u.gain_db == -3.5);
    CHECK(u.max_dbfs == -3.0);
    CHECK(u.threshold_dbfs == -41.5);
    CHECK(u.polarity == -1);
    CHECK(u.actuator == actuator_kind::voice_coil);
    CHECK(a.channels() == 8);
}

TEST_CASE("a list needs no [array], and may number its tactors")
{
    const array a = parse_array("[[tactor]]\ntactor = 0\nx_mm = 0\ny_mm = 0\n");
    CHECK(a.tactors.size() == 1);
    CHECK(complaint("[[tactor]]\ntactor = 1\nx_mm = 0\ny_mm = 0\n") ==
          "palm.toml:2:10: tactor is 1, but this is entry 0 (without a grid, tactors are numbered from 0 in "
          "the order of the file)");
}

TEST_CASE("with a grid, entries adjust the tactors that they name")
{
    const array a = parse_array(grid + "[[tactor]]\ntactor = 4\nthreshold_dbfs = -40\nchannel = 9\n"
                                       "[[tactor]]\ntactor = 0\npolarity = -1\n");
    CHECK(a.tactors[4].threshold_dbfs == -40.0);
    CHECK(a.tactors[4].channel == 9);
    CHECK(a.tactors[4].position == point{20.0, 20.0});
    CHECK(a.tactors[4].where.line == 3);
    CHECK(a.tactors[0].polarity == -1);
    CHECK(a.tactors[8].where.line == 2);
    CHECK(complaint(grid + "[[tactor]]\nthreshold_dbfs = -40\n") ==
          "palm.toml:3:1: [[tactor]] does not say which tactor it is (add tactor = INDEX, 0 to 8)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 9\n") == "palm.toml:4:10: tactor is 9 (allowed: 0 to 8)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 1\n[[tactor]]\ntactor = 1\n") ==
          "palm.toml:6:10: tactor 1 has an entry already (palm.toml:3:1) (join the two)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 1\nx_mm = 3\n") ==
          "palm.toml:5:8: [[tactor]] says x_mm, but its place comes from the grid (leave x_mm out, or the "
          "grid)");
}

TEST_CASE("a preset can be adjusted too")
{
    const array a = parse_array("[array]\npreset = \"palm-2x4\"\n[[tactor]]\ntactor = 7\ngain_db = 3\n");
    CHECK(a.name == "palm-2x4");
    CHECK(a.tactors[7].gain_db == 3.0);
    CHECK(complaint("[array]\npreset = \"palm\"\n")
              .starts_with("palm.toml:2:10: array: there is no preset 'palm'"));
}

TEST_CASE("an unknown key names the nearest, or lists the known ones")
{
    const std::string one = "[[tactor]]\nx_mm = 0\ny_mm = 0\n";
    CHECK(complaint(one + "chanel = 3\n") ==
          "palm.toml:4:1: unknown key 'chanel' in [[tactor]] (did you mean 'channel'?)");
    CHECK(complaint(one + "gain = 3\n") ==
          "palm.toml:4:1: unknown key 'gain' in [[tactor]] (did you mean 'gain_db'?)");
    CHECK(complaint(one + "max_dbsf = 3\n").ends_with("(did you mean 'max_dbfs'?)"));
    CHECK(complaint(one + "Threshold-dBFS = 3\n").ends_with("(did you mean 'threshold_dbfs'?)"));
    CHECK(complaint(one + "colour = 3\n") ==
          "palm.toml:4:1: unknown key 'colour' in [[tactor]] (known keys: x_mm, y_mm, channel, gain_db, "
          "max_dbfs, threshold_dbfs, polarity, actuator, rise_ms, displacement_um_at_0dbfs, tactor)");
    CHECK(complaint("[aray]\nname = \"x\"\n") ==
          "palm.toml:1:2: unknown key 'aray' in the file (did you mean 'array'?)");
    CHECK(complaint("[array]\ngrid = { rows = 3, colums = 3, pitch_mm = 20 }\n") ==
          "palm.toml:2:20: unknown key 'colums' in grid (did you mean 'columns'?)");
    CHECK(complaint("[array]\ngrid = { rows = 3, columns = 3, pitch = 20 }\n")
              .ends_with("(did you mean 'pitch_mm'?)"));
    CHECK(complaint("[array]\nzz = 1\naa = 1\n").starts_with("palm.toml:2:1: unknown key 'zz'"));
    CHECK(complaint(one + "a = 1\n").find("known keys: x_mm") != std::string::npos);
    CHECK(complaint(std::string("\"") + std::string(5000, 'a') + "\" = 1\n").size() < 200);
}

TEST_CASE("wrong types and ranges are reported at the value")
{
    const std::string one = "[[tactor]]\nx_mm = 0\ny_mm = 0\n";
    CHECK(complaint(one + "channel = 1.0\n") == "palm.toml:4:11: channel is 1.0 (give a whole number)");
    CHECK(complaint(one + "channel = \"1\"\n") == "palm.toml:4:11: channel is '1' (give a whole number)");
    CHECK(complaint(one + "channel = -1\n") == "palm.toml:4:11: channel is -1 (allowed: 0 to 1023)");
    CHECK(complaint(one + "channel = 1024\n") == "palm.toml:4:11: channel is 1024 (allowed: 0 to 1023)");
    CHECK(complaint(one + "channel = 4294967296\n") ==
          "palm.toml:4:11: channel is 4294967296 (allowed: 0 to 1023)");
    CHECK(complaint(one + "gain_db = nan\n") == "palm.toml:4:11: gain_db is nan (allowed: -200 to 60)");
    CHECK(complaint(one + "gain_db = 61\n") == "palm.toml:4:11: gain_db is 61 (allowed: -200 to 60)");
    CHECK(complaint(one + "max_dbfs = 1\n") == "palm.toml:4:12: max_dbfs is 1 (allowed: -200 to 0)");
    CHECK(complaint(one + "threshold_dbfs = -inf\n") ==
          "palm.toml:4:18: threshold_dbfs is -inf (allowed: -200 to 0)");
    CHECK(complaint(one + "polarity = 0\n") ==
          "palm.toml:4:12: polarity is 0 (1, or -1 where it is wired the other way round)");
    CHECK(complaint(one + "threshold_dbfs = [[1, -200], [384000, 0]]\n").empty());
    CHECK(complaint(one + "threshold_dbfs = [[0.9, -20]]\n") ==
          "palm.toml:4:19: the frequency is 0.9 (allowed: 1 to 384000)");
    CHECK(complaint(one + "threshold_dbfs = [[384001, -20]]\n") ==
          "palm.toml:4:19: the frequency is 384001 (allowed: 1 to 384000)");
    CHECK(complaint(one + "threshold_dbfs = [[100, -20], [100, -41]]\n") ==
          "palm.toml:4:31: the frequency 100 does not come after 100 (put thresholds in order of frequency, "
          "each once)");
    CHECK(parse_array(one + "rise_ms = 1000\n").tactors[0].rise_s == 1.0);
    CHECK(complaint(one + "rise_ms = 1001\n").starts_with("palm.toml:4:11: rise_ms is 1001 (allowed: "));
    CHECK(complaint(one + "polarity = 1.5\n") == "palm.toml:4:12: polarity is 1.5 (allowed: -1 to 1)");
    CHECK(complaint(one + "polarity = -1.5\n") == "palm.toml:4:12: polarity is -1.5 (allowed: -1 to 1)");
    CHECK(complaint(one + "polarity = true\n") == "palm.toml:4:12: polarity is true (give a number)");
    CHECK(complaint(one + "actuator = \"peizo\"\n") ==
          "palm.toml:4:12: actuator is 'peizo' (did you mean 'piezo'?)");
    for (const actuator_kind k : all_values<actuator_kind>()) {
        const std::string line = fmt::format("actuator = \"{}\"\n", to_string(k));
        if (k == actuator_kind::unknown)
            CHECK(complaint(one + line) ==
                  "palm.toml:4:12: actuator is 'unknown' (known values: piezo, voice-coil, lra, erm)");
        else
            CHECK(parse_array(one + line).tactors[0].actuator == k);
    }
    CHECK(complaint("[[tactor]]\nx_mm = inf\ny_mm = 0\n") ==
          "palm.toml:2:8: x_mm is inf (allowed: -1000000 to 1000000)");
    CHECK(complaint("[[tactor]]\nx_mm = 1e7\ny_mm = 0\n") ==
          "palm.toml:2:8: x_mm is 10000000 (allowed: -1000000 to 1000000)");
    CHECK(complaint("[[tactor]]\nx_mm = [1]\ny_mm = 0\n") == "palm.toml:2:8: x_mm is a list (give a number)");
    CHECK(complaint("[[tactor]]\nx_mm = 1979-05-27\ny_mm = 0\n") ==
          "palm.toml:2:8: x_mm is a date or time (give a number)");
    CHECK(complaint("[[tactor]]\nx_mm = 1\n") == "palm.toml:1:1: [[tactor]] has no y_mm (add y_mm = ...)");
    CHECK(complaint("tactor = 3\n") == "palm.toml:1:10: tactor is 3 (give [[tactor]] entries)");
    CHECK(complaint("array = \"palm-3x3\"\n") ==
          "palm.toml:1:9: array is 'palm-3x3' (give a table, [array])");
}

TEST_CASE("an array file keeps the measured displacement, of all tactors or of one")
{
    const array a = parse_array(grid + "displacement_um_at_0dbfs = 35.5\n[[tactor]]\ntactor = 1\n"
                                       "displacement_um_at_0dbfs = 20\n");
    CHECK(a.tactors[0].displacement_um_at_0dbfs == 35.5);
    CHECK(a.tactors[1].displacement_um_at_0dbfs == 20.0);
    CHECK(parse_array(detail::array_text(a)).tactors[1].displacement_um_at_0dbfs == 20.0);
    CHECK(complaint(grid + "displacement_um_at_0dbfs = 0\n") ==
          "palm.toml:3:28: displacement_um_at_0dbfs is 0 (allowed: more than 0, at most 10000)");
}

TEST_CASE("an array says where on the body it is, and which way up")
{
    const array a = parse_array(grid + "site = \"left palm\"\nup = \"fingers\"\n");
    CHECK(a.site == "left palm");
    CHECK(a.up == "fingers");
    const array again = parse_array(detail::array_text(a));
    CHECK(again.site == a.site);
    CHECK(again.up == a.up);
    const array placed = parse_array(grid + "place = [1, -56.5]\nturn = 15\nbody = 180\n");
    const array again_placed = parse_array(detail::array_text(placed));
    for (const array& p : {placed, again_placed}) {
        REQUIRE(p.place);
        CHECK(p.place->x_mm == 1.0);
        CHECK(p.place->y_mm == -56.5);
        CHECK(p.turn_deg == 15.0);
        CHECK(p.body_mm == 180.0);
    }
    CHECK_FALSE(a.place);
    CHECK(complaint(grid + "place = [1]\n") == "palm.toml:3:9: place is a list (give a list of 2 numbers)");
    CHECK(complaint(grid + "body = 0\n") == "palm.toml:3:8: body is 0 (allowed: 1 to 3000)");
    CHECK(parse_array(grid).site.empty());
    CHECK(detail::array_text(parse_array(grid)).find("site") == std::string::npos);
    CHECK(parse_array("[array]\npreset = \"palm-3x3\"\nsite = \"\u5de6\u624b\"\n").site ==
          "\xe5\xb7\xa6\xe6\x89\x8b");
    CHECK(parse_array(grid + "site = \"" + std::string(40, 'x') + "\"\n").site.size() == 40);
    CHECK(complaint(grid + "site = \"" + std::string(41, 'x') + "\"\n") ==
          "palm.toml:3:8: site has 41 characters (1 to 40 characters, no control characters)");
    CHECK(complaint(grid + "\n up = \"a\\nb\"\n") ==
          "palm.toml:4:7: up has control characters (1 to 40 characters, no control characters)");
    CHECK(complaint(grid + "up = \"\"\n") == "palm.toml:3:6: up is empty");
    CHECK(complaint(grid + "site = 3\n") == "palm.toml:3:8: site is 3 (give a string in quotes)");
    CHECK(complaint(grid + "sites = \"x\"\n") ==
          "palm.toml:3:1: unknown key 'sites' in [array] (did you mean 'site'?)");
}

TEST_CASE("impossible grids are refused")
{
    const auto of = [](const std::string& g) { return complaint("[array]\ngrid = " + g + "\n"); };
    CHECK(of("{ rows = 3, columns = 3 }") == "palm.toml:2:8: grid has no pitch_mm (add pitch_mm = ...)");
    CHECK(of("{ rows = 0, columns = 3, pitch_mm = 2 }") == "palm.toml:2:17: rows is 0 (allowed: 1 to 1024)");
    CHECK(of("{ rows = 1024, columns = 2, pitch_mm = 2 }") ==
          "palm.toml:2:8: grid: 1024 rows x 2 columns (1 to 1024 tactors)");
    CHECK(of("{ rows = 3, columns = 3, pitch_mm = 0 }") ==
          "palm.toml:2:44: pitch_mm is 0 (allowed: more than 0, at most 1000000)");
    CHECK(
        of("{ rows = 3, columns = 3, pitch_mm = [1, nan] }").starts_with("palm.toml:2:48: pitch_mm is nan"));
    CHECK(of("{ rows = 3, columns = 3, pitch_mm = [1] }") ==
          "palm.toml:2:44: pitch_mm has 1 number (give one, or [x, y])");
    CHECK(of("3") == "palm.toml:2:8: grid is 3 (give a table, grid = { rows, columns, pitch_mm })");
    // Pitch in range, extent not.
    CHECK(of("{ rows = 1, columns = 3, pitch_mm = 1e6 }")
              .starts_with("palm.toml:2:8: tactor 2 is at (2000000, 0) mm"));
    // Pitch so small that tactors coincide.
    CHECK(of("{ rows = 1, columns = 3, pitch_mm = 1e-7 }").find("the place of tactor 0") !=
          std::string::npos);
    CHECK(of("{ rows = 32, columns = 32, pitch_mm = 1 }").empty());
}

TEST_CASE("an array comes from one source")
{
    CHECK(complaint("[array]\nname = \"x\"\n") ==
          "palm.toml:1:1: [array] has no tactors (add grid, preset or file, or [[tactor]] entries)");
    CHECK(complaint("[array]\npreset = \"palm-3x3\"\nfile = \"a.toml\"\n") ==
          "palm.toml:3:8: [array] has both preset and file (keep one of them)");
    CHECK(complaint("[array]\nname = \"x\"\n[[array.tactor]]\nx_mm = 0\n") ==
          "palm.toml:3:1: tactors inside [array] (write [[tactor]], which stands beside [array])");
    CHECK(complaint("[array]\nname = \"\"\n").starts_with("palm.toml:1:1"));
    CHECK(complaint("[stroke]\nduration_s = 1\n") ==
          "palm.toml:1:1: this is a stroke file, not an array or configuration (name it as the STROKE)");
    CHECK(
        complaint("t_s,x_mm,y_mm\n0,1,2\n") ==
        "palm.toml:1:1: is a table (CSV) (arrays and configurations are TOML; points, drawings and plans are "
        "strokes)");
}

TEST_CASE("two tactors on one place or channel are refused with both lines")
{
    CHECK(complaint("[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]]\nx_mm = 1\ny_mm = 0\nchannel = 0\n") ==
          "palm.toml:4:1: tactor 1 is on channel 0, that of tactor 0 (palm.toml:1:1) (give each tactor a "
          "channel of its own)");
    CHECK(complaint("[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]]\nx_mm = 5e-7\ny_mm = 0\n") ==
          "palm.toml:4:1: tactor 1 is at (5e-07, 0) mm, the place of tactor 0 (palm.toml:1:1) (give each "
          "tactor a place of its own)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 4\nchannel = 0\n") ==
          "palm.toml:3:1: tactor 4 is on channel 0, that of tactor 0 (palm.toml:2:8) (give each tactor a "
          "channel of its own)");
}

TEST_CASE("1024 tactors in a list are read, one more is refused")
{
    std::string text;
    for (int i = 0; i < 1024; ++i)
        text += fmt::format("[[tactor]]\nx_mm = {}\ny_mm = {}\n", i % 128, i / 128);
    CHECK(parse_array(text).tactors.size() == 1024);
    CHECK(complaint(text + "[[tactor]]\nx_mm = -1\ny_mm = 0\n") ==
          "palm.toml:3073:1: more than 1024 tactors");
}

} // namespace setup_array_test
