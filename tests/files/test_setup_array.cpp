// SPDX-License-Identifier: MIT
// Array files, and the places where set-ups are looked for.
#include <filesystem>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/setup.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "rounds.hpp"

namespace setup_array_test {

namespace fs = std::filesystem;
using namespace tactor;

namespace {

std::string complaint(const std::string& text)
{
    return caught_message([&] { return parse_setup(text, "palm.toml"); });
}

array parse_array(const std::string& text)
{
    const setup s = parse_setup(text, "palm.toml");
    REQUIRE(s.array.has_value());
    return *s.array;
}

const std::string grid = "[array]\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n";

std::string file_complaint(const fs::path& file)
{
    return caught_message([&] { return load_setup(file); });
}

const std::string arm = "[array]\nname = \"arm\"\ngrid = { rows = 1, columns = 4, pitch_mm = 40 }\n";

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

    has(complaint("[array]\npreset = \"palm-3x3\"\nmirror = \"z\"\n"), "palm.toml:3");
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
          "palm.toml:2:10: tactor is 1, but this is entry 0 (without a grid, number the tactors from 0 in "
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
          "palm.toml:3:1: [[tactor]] has no tactor number (add tactor = INDEX, 0 to 8)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 9\n") == "palm.toml:4:10: tactor is 9 (use 0 to 8)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 1\n[[tactor]]\ntactor = 1\n") ==
          "palm.toml:6:10: tactor 1 has another entry (palm.toml:3:1) (join the two entries)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 1\nx_mm = 3\n") ==
          "palm.toml:5:8: [[tactor]] has x_mm, but its place comes from the grid (leave out x_mm, or the "
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
    CHECK(complaint(one + "channel = -1\n") == "palm.toml:4:11: channel is -1 (use 0 to 1023)");
    CHECK(complaint(one + "channel = 1024\n") == "palm.toml:4:11: channel is 1024 (use 0 to 1023)");
    CHECK(complaint(one + "channel = 4294967296\n") ==
          "palm.toml:4:11: channel is 4294967296 (use 0 to 1023)");
    CHECK(complaint(one + "gain_db = nan\n") == "palm.toml:4:11: gain_db is nan (use -200 to 60)");
    CHECK(complaint(one + "gain_db = 61\n") == "palm.toml:4:11: gain_db is 61 (use -200 to 60)");
    CHECK(complaint(one + "max_dbfs = 1\n") == "palm.toml:4:12: max_dbfs is 1 (use -200 to 0)");
    CHECK(complaint(one + "threshold_dbfs = -inf\n") ==
          "palm.toml:4:18: threshold_dbfs is -inf (use -200 to 0)");
    CHECK(complaint(one + "polarity = 0\n") ==
          "palm.toml:4:12: polarity is 0 (use 1, or -1 if its wires are swapped)");
    CHECK(complaint(one + "threshold_dbfs = [[1, -200], [384000, 0]]\n").empty());
    CHECK(complaint(one + "threshold_dbfs = [[0.9, -20]]\n") ==
          "palm.toml:4:20: the frequency is 0.9 (use 1 to 384000)");
    CHECK(complaint(one + "threshold_dbfs = [[384001, -20]]\n") ==
          "palm.toml:4:20: the frequency is 384001 (use 1 to 384000)");
    CHECK(complaint(one + "threshold_dbfs = [[100, -20], [100, -41]]\n") ==
          "palm.toml:4:31: the frequency 100 Hz is not above the previous one, 100 Hz (give each frequency "
          "once, in ascending order)");
    CHECK(parse_array(one + "rise_ms = 1000\n").tactors[0].rise_s == 1.0);
    CHECK(complaint(one + "rise_ms = 1001\n").starts_with("palm.toml:4:11: rise_ms is 1001 (use "));
    CHECK(complaint(one + "polarity = 1.5\n") == "palm.toml:4:12: polarity is 1.5 (use -1 to 1)");
    CHECK(complaint(one + "polarity = -1.5\n") == "palm.toml:4:12: polarity is -1.5 (use -1 to 1)");
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
          "palm.toml:2:8: x_mm is inf (use -1000000 to 1000000)");
    CHECK(complaint("[[tactor]]\nx_mm = 1e7\ny_mm = 0\n") ==
          "palm.toml:2:8: x_mm is 10000000 (use -1000000 to 1000000)");
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
          "palm.toml:3:28: displacement_um_at_0dbfs is 0 (use more than 0, at most 10000)");
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
    CHECK(complaint(grid + "place = [1]\n") == "palm.toml:3:9: place has 1 value (give 2 numbers)");
    CHECK(complaint(grid + "body = 0\n") == "palm.toml:3:8: body is 0 (use 1 to 3000)");
    CHECK(parse_array(grid).site.empty());
    CHECK(detail::array_text(parse_array(grid)).find("site") == std::string::npos);
    CHECK(parse_array("[array]\npreset = \"palm-3x3\"\nsite = \"\u5de6\u624b\"\n").site ==
          "\xe5\xb7\xa6\xe6\x89\x8b");
    CHECK(parse_array(grid + "site = \"" + std::string(40, 'x') + "\"\n").site.size() == 40);
    CHECK(complaint(grid + "site = \"" + std::string(41, 'x') + "\"\n") ==
          "palm.toml:3:8: site has 41 characters (use 1 to 40 characters, no control characters)");
    CHECK(complaint(grid + "\n up = \"a\\nb\"\n") ==
          "palm.toml:4:7: up has control characters (use 1 to 40 characters, no control characters)");
    CHECK(complaint(grid + "up = \"\"\n") == "palm.toml:3:6: up is empty");
    CHECK(complaint(grid + "site = 3\n") == "palm.toml:3:8: site is 3 (give a string in quotes)");
    CHECK(complaint(grid + "sites = \"x\"\n") ==
          "palm.toml:3:1: unknown key 'sites' in [array] (did you mean 'site'?)");
}

TEST_CASE("impossible grids are refused")
{
    const auto of = [](const std::string& g) { return complaint("[array]\ngrid = " + g + "\n"); };
    CHECK(of("{ rows = 3, columns = 3 }") == "palm.toml:2:8: grid has no pitch_mm (add pitch_mm = ...)");
    CHECK(of("{ rows = 0, columns = 3, pitch_mm = 2 }") == "palm.toml:2:17: rows is 0 (use 1 to 1024)");
    CHECK(of("{ rows = 1024, columns = 2, pitch_mm = 2 }") ==
          "palm.toml:2:8: grid: it has 1024 rows x 2 columns (give 1 to 1024 tactors)");
    CHECK(of("{ rows = 3, columns = 3, pitch_mm = 0 }") ==
          "palm.toml:2:44: pitch_mm is 0 (use more than 0, at most 1000000)");
    CHECK(
        of("{ rows = 3, columns = 3, pitch_mm = [1, nan] }").starts_with("palm.toml:2:48: pitch_mm is nan"));
    CHECK(of("{ rows = 3, columns = 3, pitch_mm = [1] }") ==
          "palm.toml:2:44: pitch_mm has 1 number (give one, or [x, y])");
    CHECK(of("3") == "palm.toml:2:8: grid is 3 (give a table, grid = { rows, columns, pitch_mm })");
    // Pitch in range, extent not.
    CHECK(of("{ rows = 1, columns = 3, pitch_mm = 1e6 }")
              .starts_with("palm.toml:2:8: tactor 2 is at (2000000, 0) mm"));
    // Pitch so small that tactors coincide.
    has(of("{ rows = 1, columns = 3, pitch_mm = 1e-7 }"), "like tactor 0");
    CHECK(of("{ rows = 32, columns = 32, pitch_mm = 1 }").empty());
}

TEST_CASE("an array comes from one source")
{
    CHECK(complaint("[array]\nname = \"x\"\n") ==
          "palm.toml:1:1: [array] has no tactors (add grid, preset or file, or [[tactor]] entries)");
    CHECK(complaint("[array]\npreset = \"palm-3x3\"\nfile = \"a.toml\"\n") ==
          "palm.toml:3:8: [array] has both preset and file (keep one of them)");
    CHECK(complaint("[array]\nname = \"x\"\n[[array.tactor]]\nx_mm = 0\n") ==
          "palm.toml:3:1: [[tactor]] is inside [array] (write [[tactor]] at the top level of the file)");
    CHECK(complaint("[array]\nname = \"\"\n").starts_with("palm.toml:1:1"));
    CHECK(complaint("[stroke]\nduration_s = 1\n") ==
          "palm.toml:1:1: this is a stroke file, not an array or configuration (give it as the STROKE)");
    CHECK(complaint("t_s,x_mm,y_mm\n0,1,2\n") ==
          "palm.toml:1:1: it is a table (CSV) (use TOML for an array or a configuration; give points, "
          "drawings and plans as the STROKE)");
}

TEST_CASE("two tactors on one place or channel are refused with both lines")
{
    CHECK(complaint("[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]]\nx_mm = 1\ny_mm = 0\nchannel = 0\n") ==
          "palm.toml:4:1: tactor 1 is on channel 0, like tactor 0 (palm.toml:1:1) (give each tactor its "
          "own channel)");
    CHECK(complaint("[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]]\nx_mm = 5e-7\ny_mm = 0\n") ==
          "palm.toml:4:1: tactor 1 is at (5e-07, 0) mm, like tactor 0 (palm.toml:1:1) (give each "
          "tactor its own place)");
    CHECK(complaint(grid + "[[tactor]]\ntactor = 4\nchannel = 0\n") ==
          "palm.toml:3:1: tactor 4 is on channel 0, like tactor 0 (palm.toml:2:8) (give each tactor its "
          "own channel)");
}

TEST_CASE("1024 tactors in a list are read, one more is refused")
{
    std::string text;
    for (int i = 0; i < 1024; ++i)
        text += fmt::format("[[tactor]]\nx_mm = {}\ny_mm = {}\n", i % 128, i / 128);
    CHECK(parse_array(text).tactors.size() == 1024);
    CHECK(complaint(text + "[[tactor]]\nx_mm = -1\ny_mm = 0\n") ==
          "palm.toml:3073:1: the array has more than 1024 tactors");
}

TEST_CASE("an unreadable file is named with the reason")
{
    const folder f;
    const std::string missing = (f / "none.toml").string();
    CHECK(file_complaint(missing) == missing + ": No such file or directory (check the name)");
    CHECK(file_complaint(f / "") == (f / "").string() + ": it is a folder (name a file in it)");
    CHECK(file_complaint(f.write("file", "") / "below").find("Not a directory") != std::string::npos);
}

TEST_CASE("an error of a file has its place and the key, as parts")
{
    const folder f;
    const auto place_and_key = [&](const fs::path& file) -> std::string {
        try {
            static_cast<void>(load_setup(file));
        } catch (const error& e) {
            return fmt::format("{}, {}, {}, {}", fs::path(e.place().file).filename().string(), e.place().line,
                               e.place().column, e.field());
        }
        return "";
    };
    CHECK(place_and_key(f / "none.toml") == "none.toml, 0, 0, ");
    CHECK(place_and_key(f.write("a.toml", "[array]\n\npich = 3\n")) == "a.toml, 3, 1, pich");
    CHECK(place_and_key(f.write("b.toml", "[output]\nrate = \"x\"\n")) == "b.toml, 2, 8, rate");
    CHECK(place_and_key(f.write("c.toml", "[output]\nrate = 1\n")) == "c.toml, 2, 8, rate");
    CHECK(place_and_key(f.write("d.toml", "[array\n")) == "d.toml, 1, 7, ");
}

TEST_CASE("a file of more than 16 MB is refused, an endless one too")
{
    const folder f;
    // Shows by a fault that a file of 16 MB is parsed: a comment as long takes the parser a second.
    const std::string full(std::size_t{16} << 20, '#');
    CHECK(file_complaint(f.write("full.toml", "=" + full.substr(1))).find("full.toml:1:1: ") !=
          std::string::npos);
    if (test::whole())
        CHECK(file_complaint(f.write("full.toml", full)).empty());
    const fs::path more = f.write("more.toml", "#" + std::string(std::size_t{16} << 20, ' '));
    CHECK(file_complaint(more) ==
          more.string() + ": it is larger than 16 MB (check that it is the right file)");
    CHECK(file_complaint("/dev/zero") ==
          "/dev/zero: it is larger than 16 MB (check that it is the right file)");
}

TEST_CASE("an array from another file, relative to the file that names it")
{
    const folder f;
    f.write("arrays/arm.toml", arm + "[output]\npcm = \"null\"\nchannels = 8\n[defaults]\nsoa = 0.06\n");
    const setup s = load_setup(f.write("tactor.toml", R"(
[array]
file = "arrays/arm.toml"
[[tactor]]
tactor = 2
threshold_dbfs = -40
[output]
channels = 10
[defaults]
speed = 70
)"));
    REQUIRE(s.array.has_value());
    CHECK(s.array->name == "arm");
    CHECK(s.array->tactors.size() == 4);
    CHECK(s.array->tactors[2].threshold_dbfs == -40.0);
    CHECK(s.array->tactors[2].where.text() == (f / "tactor.toml").string() + ":4:1");
    CHECK(s.array->tactors[1].where.text() == (f / "arrays/arm.toml").string() + ":3:8");
    // Other keys of that file hold, unless this one has them.
    CHECK(s.output.pcm == "null");
    CHECK(s.output.pcm_included);
    CHECK(s.output.pcm_at.text() == (f / "arrays/arm.toml").string() + ":5:7");
    CHECK(s.output.channels == 10u);
    CHECK(s.defaults ==
          std::vector<written_value>{{"soa", 0.06, false, {}, {}}, {"speed", 70.0, false, {}, {}}});

    f.write("arrays/palm.toml",
            arm.substr(0, 8) + "site = \"left palm\"\nup = \"fingers\"\n" + arm.substr(8));
    const setup placed =
        load_setup(f.write("placed.toml", "[array]\nfile = \"arrays/palm.toml\"\nup = \"thumb\"\n"));
    CHECK(placed.array->site == "left palm");
    CHECK(placed.array->up == "thumb");

    const setup named =
        load_setup(f.write("named.toml", "[array]\nname = \"left\"\nfile = \"arrays/arm.toml\"\n"));
    CHECK(named.array->name == "left");
}

TEST_CASE("the channel count of one file is checked against the map of another")
{
    const folder f;
    f.write("arm.toml", arm);
    const fs::path c = f.write("c.toml", "[array]\nfile = \"arm.toml\"\n[output]\nchannels = 3\n");
    CHECK(file_complaint(c) == fmt::format("{}:4:12: channels is 3, but tactor 3 ({}:3:8) is on channel 3 "
                                           "(use 4 channels or more: they count from 0)",
                                           c.string(), (f / "arm.toml").string()));
}

TEST_CASE("included files that are missing, wrong or without an array are refused")
{
    const folder f;
    const fs::path a = f.write("a.toml", "[array]\nfile = \"b.toml\"\n");
    const std::string at = a.string() + ":2:8: ";
    const std::string b = (f / "b.toml").string();
    CHECK(file_complaint(a) == at + b + ": No such file or directory (check the name)");
    f.write("b.toml", "[output]\nrate = 48000\n");
    CHECK(file_complaint(a) == at + b + " has no array (name an array file)");
    f.write("b.toml", "[array]\nnam = 1\n");
    CHECK(file_complaint(a) == b + ":2:1: unknown key 'nam' in [array] (did you mean 'name'?)");
}

TEST_CASE("a chain of files has a limit")
{
    const folder f;
    for (int i = 0; i < 100; ++i)
        f.write(fmt::format("{}.toml", i), fmt::format("[array]\nfile = \"{}.toml\"\n", i + 1));
    f.write("100.toml", arm);
    CHECK(file_complaint(f / "0.toml") ==
          (f / "15.toml").string() +
              ":2:8: the chain of files is too long (use at most 16 files, and no file that names itself)");
    CHECK(file_complaint(f / "85.toml").empty());
    has(file_complaint(f.write("own.toml", "[array]\nfile = \"own.toml\"\n")), "no file that names itself");
}

} // namespace setup_array_test
