// SPDX-License-Identifier: MIT
// [output], [amplifier], [sync] and [defaults]; texts that are not TOML.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <clocale>
#include <string>

#include <tactor/setup.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
#include "has.hpp"

namespace setup_test {

using namespace tactor;

namespace {

setup read(const std::string& text)
{
    return parse_setup(text, "t.toml");
}

std::string complaint(const std::string& text)
{
    return caught_message([&] { read(text); });
}

// The format's example, with all tables.
const std::string whole = R"([array]
name = "palm-3x3"
grid = { rows = 3, columns = 3, pitch_mm = 20.0 }

[output]
pcm = "hw:CARD=Tactor"
rate = 48000
channels = 16
period_frames = 96
periods = 3

[amplifier]
line = { chip = "pinctrl-rp1", offset = 17 }
active_low = true
settle_ms = 12.5

[sync]
out = { chip = "pinctrl-rp1", offset = 27, pulse_ms = 4 }
channel = 15
in  = { name = "GPIO22", edge = "falling", debounce_ms = 2.5, pull = "up" }

[limits]
power_dbfs = 3
max_drive_s = 2.5

[defaults]
algorithm = "tactile-brush"
soa = 0.06
speed = 80
snap = true
rate = 96000
level-dbfs = "-20"
)";

std::string with(std::string from, const std::string& to)
{
    std::string text = whole;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

} // namespace

TEST_CASE("a whole configuration is read")
{
    const setup s = read(whole);
    CHECK(s.array->tactors.size() == 9);
    CHECK(s.output.pcm == "hw:CARD=Tactor");
    CHECK(s.output.pcm_at.text() == "t.toml:6:7");
    CHECK_FALSE(s.output.pcm_included);
    CHECK(s.output.rate == 48000u);
    CHECK(s.output.channels == 16u);
    CHECK(s.output.period_frames == 96u);
    CHECK(s.limits->power_dbfs == 3.0);
    CHECK(s.limits->max_drive_s == 2.5);
    CHECK_FALSE(s.limits->window_s);
    CHECK(s.output.periods == 3u);
    REQUIRE(s.amplifier.has_value());
    CHECK(s.amplifier->line.chip == "pinctrl-rp1");
    CHECK(s.amplifier->line.offset == 17u);
    CHECK(s.amplifier->line.where.text() == "t.toml:13:8");
    CHECK(s.amplifier->active_low);
    CHECK(s.amplifier->settle_s == 0.0125);
    REQUIRE(s.sync.has_value());
    CHECK(s.sync->out->offset == 27u);
    CHECK(s.sync->pulse_s == 0.004);
    CHECK(s.sync->channel == 15u);
    CHECK(s.sync->in->name == "GPIO22");
    CHECK_FALSE(s.sync->in->offset.has_value());
    CHECK(s.sync->edge == edge_kind::falling);
    CHECK(s.sync->debounce_s == 0.0025);
    CHECK(s.sync->pull == pull_kind::up);
    CHECK(s.defaults.size() == 6);
}

TEST_CASE("keys that a file leaves out are left to the program")
{
    for (const char* text : {"", "# nothing\n", "[output]\n", "\xef\xbb\xbf# with a byte order mark\r\n"}) {
        const setup s = read(text);
        CHECK_FALSE(s.array.has_value());
        CHECK_FALSE(s.output.pcm.has_value());
        CHECK_FALSE(s.output.channels.has_value());
        CHECK_FALSE(s.amplifier.has_value());
        CHECK_FALSE(s.sync.has_value());
        CHECK(s.defaults.empty());
    }
    const setup s = read("[amplifier]\nline = { name = \"GPIO17\" }\n[sync]\n");
    CHECK_FALSE(s.amplifier->active_low);
    CHECK(s.amplifier->settle_s == 0.010);
    CHECK(s.sync->pulse_s == 0.005);
    CHECK(s.sync->edge == edge_kind::rising);
    CHECK(s.sync->debounce_s == 0.001);
    CHECK(s.sync->pull == pull_kind::as_is);
    CHECK_FALSE(s.sync->out.has_value());
}

TEST_CASE("[output] out of range is refused")
{
    CHECK(complaint(with("rate = 48000", "rate = 7999")) == "t.toml:7:8: rate is 7999 (use 8000 to 768000)");
    CHECK(complaint(with("rate = 48000", "rate = 48000.0")) ==
          "t.toml:7:8: rate is 48000.0 (give a whole number)");
    CHECK(complaint(with("period_frames = 96", "period_frames = 2")) ==
          "t.toml:9:17: period_frames is 2 (use 3 to 1048576)");
    CHECK(complaint("[output]\nrate = 768000\nperiod_frames = 1\nperiods = 2\n") ==
          "t.toml:3:17: period_frames is 1 (use 39 to 1048576)");
    CHECK(read("[output]\nrate = 8000\nperiod_frames = 1\n").output.period_frames == 1u);
    CHECK(complaint(with("periods = 3", "periods = 1")) == "t.toml:10:11: periods is 1 (use 2 to 1024)");
    CHECK(complaint(with("\"hw:CARD=Tactor\"", "\"\"")) == "t.toml:6:7: pcm is empty");
    CHECK(complaint(with("\"hw:CARD=Tactor\"", "hw")).starts_with("t.toml:6:"));
    CHECK(complaint(with("period_frames", "period_frame")) ==
          "t.toml:9:1: unknown key 'period_frame' in [output] (did you mean 'period_frames'?)");
    CHECK(complaint(with("[output]", "[ouput]")) ==
          "t.toml:5:2: unknown key 'ouput' in the file (did you mean 'output'?)");
    CHECK(complaint(with("channels = 16", "channels = 1025")) ==
          "t.toml:8:12: channels is 1025 (use 1 to 1024)");
}

TEST_CASE("fewer channels than the map or the marker needs are refused")
{
    CHECK(complaint("[array]\npreset = \"palm-3x3\"\n[output]\nchannels = 8\n") ==
          "t.toml:4:12: channels is 8, but tactor 8 (t.toml:2:10) is on channel 8 (use 9 channels or more: "
          "they count from 0)");
    CHECK(complaint("[array]\npreset = \"palm-3x3\"\n[output]\nchannels = 9\n").empty());
    CHECK(complaint(with("channels = 16", "channels = 15")) ==
          "t.toml:19:11: the marker's channel is 15, but there are 15 channels (t.toml:8:12) (count channels "
          "from 0)");
    CHECK(complaint("[output]\nchannels = 1\n[sync]\nchannel = 1\n") ==
          "t.toml:4:11: the marker's channel is 1, but there is 1 channel (t.toml:2:12) (count channels from "
          "0)");
    CHECK(complaint(with("channel = 15", "channel = 3")) ==
          "t.toml:19:11: the marker's channel, 3, is also that of tactor 3 (t.toml:3:8) (give the marker a "
          "channel "
          "without a tactor)");
}

TEST_CASE("[sync] code says where numbers go, and [sync.codes] which")
{
    const setup s =
        read("[sync]\nout = { chip = \"a\", offset = 4 }\ncode = { channel = 15, bit_ms = 1, chip = \"a\", "
             "offsets = [5, 6], pulse_ms = 7, lsl = true, serial = \"/dev/ttyS0\", baud = 9600 "
             "}\n[sync.codes]\nstimulus = 1\nvoid = 3\n"
             "standard = { first = 4, by = [\"motion\", \"interval\"] }\ncatch = { by = [] }\n");
    REQUIRE(s.sync->code.has_value());
    const code_settings& c = *s.sync->code;
    CHECK(c.channel == 15u);
    CHECK(c.bit_s == 0.001);
    CHECK(c.chip == "a");
    CHECK(c.offsets == std::vector<unsigned>{5, 6});
    CHECK(c.pulse_s == 0.007);
    CHECK(c.lsl);
    CHECK(c.serial == "/dev/ttyS0");
    CHECK(c.baud == 9600);
    CHECK(c.stimulus.first == 1u);
    CHECK(!c.stimulus.by);
    CHECK(!c.answer.first);
    CHECK(c.made_void.first == 3u);
    CHECK(c.standard.first == 4u);
    CHECK(c.standard.by == std::vector<std::string>{"motion", "interval"});
    CHECK(!c.caught.first);
    CHECK(c.caught.by == std::vector<std::string>{});
    const std::string again = detail::format_settings(s);
    CHECK(detail::format_settings(read(again)) == again);

    const auto code = [](const std::string& in) { return complaint("[sync]\ncode = " + in + "\n"); };
    CHECK(code("{ bit_ms = 2 }") == "t.toml:2:8: code has neither channel nor chip nor serial (code = { "
                                    "channel = 15 }, { chip, offsets } "
                                    "or { serial, baud })");
    CHECK(code("{ baud = 9600 }") == "t.toml:2:8: code has no serial (add serial = ...)");
    CHECK(code("{ serial = \"/dev/ttyS0\", baud = 9601 }") ==
          "t.toml:2:40: baud is 9601 (use one of 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, "
          "500000, "
          "576000, 921600, 1000000, 1152000, 1500000, 2000000)");
    CHECK(read("[sync]\ncode = { serial = \"/dev/ttyS0\" }\n").sync->code->baud == 115200);
    CHECK(code("{ chip = \"a\" }") ==
          "t.toml:2:8: there are 0 offsets (give one to eight lines, the least significant bit first)");
    CHECK(code("{ offsets = [1] }") == "t.toml:2:8: code has no chip (add chip = ...)");
    CHECK(code("{ chip = \"a\", offsets = [1, 1] }") ==
          "t.toml:2:8: the line is in use at t.toml:2:8 (give each purpose its own GPIO line)");
    CHECK(code("{ channel = 3 }\n[sync.codes]\nstimulus = 256") ==
          "t.toml:4:12: stimulus is 256 (use 1 to 255)");
    CHECK(code("{ channel = 3 }\n[sync.codes]\nstimulus = { by = [\"motions\"] }") ==
          "t.toml:4:19: by has 'motions' (some of run, motion, method, value, interval, answer)");
    CHECK(complaint("[sync.codes]\nstimulus = 1\n") ==
          "t.toml:1:1: nothing sends these numbers (code = { channel = 15 }, { chip, offsets } or { serial, "
          "baud })");
    CHECK(
        complaint("[sync]\nchannel = 4\ncode = { channel = 4 }\n") ==
        "t.toml:2:11: channel 4 is also that of the code (give the marker and the code different channels)");
}

TEST_CASE("a GPIO line is a chip and an offset, or a name, each line once")
{
    const auto line = [](const std::string& l) { return complaint("[amplifier]\nline = " + l + "\n"); };
    CHECK(line("{ chip = \"a\" }") == "t.toml:2:8: line has no offset (add offset = ...)");
    CHECK(line("{ chip = \"a\", name = \"b\" }") ==
          "t.toml:2:29: line has both chip and name (keep one of them)");
    CHECK(line("{ name = \"a\", offset = 2 }") ==
          "t.toml:2:31: line has both name and offset (keep the name)");
    CHECK(line("{ offset = 2 }") == "t.toml:2:8: line is incomplete (add one of: chip, name)");
    CHECK(line("{ chip = \"a\", offset = -2 }") == "t.toml:2:31: offset is -2 (use 0 to 65535)");
    CHECK(line("\"GPIO17\"") ==
          "t.toml:2:8: line is 'GPIO17' (give a table, line = { chip, offset } or { name })");
    CHECK(complaint("[amplifier]\nactive_low = true\n") ==
          "t.toml:1:1: [amplifier] has no line (add line = ...)");
    CHECK(complaint(with("offset = 27", "offset = 17")) ==
          "t.toml:18:7: the line is in use at t.toml:13:8 (give each purpose its own GPIO line)");
    CHECK(complaint(with("falling", "fall")) == "t.toml:20:33: edge is 'fall' (did you mean 'falling'?)");
    for (const pull_kind k : all_values<pull_kind>())
        CHECK(read(with("pull = \"up\"", fmt::format("pull = \"{}\"", to_string(k)))).sync->pull == k);
    CHECK(complaint(with("\"up\"", "\"sideways\"")) ==
          "t.toml:20:70: pull is 'sideways' (known values: as-is, none, up, down)");
    CHECK(complaint(with("settle_ms = 12.5", "settle_ms = -1")) ==
          "t.toml:15:13: settle_ms is -1 (use 0 to 10000)");
    CHECK(complaint(with("active_low = true", "active_low = 1")) ==
          "t.toml:14:14: active_low is 1 (give true or false)");
}

TEST_CASE("[defaults] hands on flags, numbers and texts with their places")
{
    const setup s =
        read("[defaults]\nsoa = 0.06\nnoise-seed = 9007199254740992\nsnap = true\nphantom = \"log\"\n");
    CHECK(s.defaults == std::vector<written_value>{{"soa", 0.06, false, {}, {}},
                                                   {"noise-seed", 9007199254740992.0, {}, {}},
                                                   {"snap", true, {}, {}},
                                                   {"phantom", "log", {}, {}}});
    CHECK(s.defaults[1].at.text() == "t.toml:3:14");
    CHECK(s.defaults[1].name_at.text() == "t.toml:3:1");
    CHECK(complaint("[defaults]\nsoa = []\n") ==
          "t.toml:2:7: soa is a list (give a number, a text, true or false)");
    CHECK(complaint("[defaults]\nnoise-seed = 9007199254740993\n") ==
          "t.toml:2:14: noise-seed is 9007199254740993 (give a number, a text, true or false)");
}

TEST_CASE("[defaults] is read and written in any locale")
{
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"})
        std::setlocale(LC_ALL, name); // the installed ones
    const setup s = read("[defaults]\nsoa = 0.0575\nramp = 1e-4\n");
    const std::string text = detail::format_settings(s);
    std::setlocale(LC_ALL, before.c_str());
    CHECK(text.ends_with("[defaults]\nsoa = 0.0575\nramp = 0.0001\n"));
    CHECK(read(text).defaults == s.defaults);
}

TEST_CASE("an actuator stays in the text of a setup, without the file that it came from")
{
    const std::string all = "[texture]\ngain = 0.25\nducking = 0.75\nlow_hz = 80\nhigh_hz = 250\n"
                            "emphasis_gain = 0.5\nfade_out = 0.125\n"
                            "emphasis_low_hz = 90\nemphasis_high_hz = 110\n"
                            "emphasis_low_s = 0.05\nemphasis_high_s = 0.01\n"
                            "emphasis_low_wave = \"triangle\"\nemphasis_high_wave = \"sawtooth\"\n";
    CHECK(detail::format_settings(read(all)) == "\n" + all);
    CHECK(detail::format_settings(read("[texture]\nhigh_hz = 200\n")) == "\n[texture]\n");
    CHECK(detail::format_settings(read("")).empty());
    CHECK(complaint("[texture]\nemphasis_low_wave = \"saw\"\n") ==
          "t.toml:2:21: emphasis_low_wave is 'saw' (known values: sine, square, triangle, sawtooth)");
    CHECK(complaint("[texture]\nfade_out = 2\n") == "t.toml:2:12: fade_out is 2 (use 0 to 1)");
}

TEST_CASE("bad TOML has its line")
{
    CHECK(complaint("[array]\nname = \n").starts_with("t.toml:2:"));
    CHECK(complaint("a = 1\na = 2\n").starts_with("t.toml:2:"));
    CHECK(complaint("[output]\nrate = 99999999999999999999\n").starts_with("t.toml:2:"));
    CHECK(complaint("[output]\npcm = \"\xff\"\n").starts_with("t.toml:2:"));
    CHECK(complaint("# \xc3\x28\n").starts_with("t.toml:1:"));
    CHECK(complaint(std::string("[output]\npcm = \"a\0b\"\n", 20)).starts_with("t.toml:2:"));
    CHECK(complaint("<svg/>").starts_with("t.toml:1:1:"));
}

TEST_CASE("keys and values nested without end are refused, not followed")
{
    std::string dotted = "a";
    for (int i = 0; i < 300000; ++i)
        dotted += ".a";
    CHECK(complaint(dotted + " = 1\n") == "t.toml:1:34: a key has too many parts (use at most three parts)");
    CHECK(complaint("[" + dotted + "]\n").starts_with("t.toml:1:35: a key has too many parts"));
    has(complaint("x = [\"\"\"\"a\"\"\"\"\", {" + dotted + " = 1}]\n"), "too many parts");
    CHECK(
        complaint("x = '#' # '\n" + dotted + " = 1\n").starts_with("t.toml:2:34: a key has too many parts"));
    CHECK_FALSE(complaint("a = " + std::string(300000, '[')).empty());
    // Dots outside keys.
    CHECK(
        complaint(
            "[output]\npcm = \"a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t\" # . . . . . . . . . . . . . . . .\n")
            .empty());
}

TEST_CASE("impossible limits are reported")
{
    for (const char* said : {"power_dbfs = nan", "power_dbfs = 61", "max_drive_s = 0", "max_drive_s = -1",
                             "window_s = inf", "window = 10"}) {
        CAPTURE(said);
        CHECK(complaint(std::string("[limits]\n") + said).starts_with("t.toml:2:"));
    }
}

} // namespace setup_test
