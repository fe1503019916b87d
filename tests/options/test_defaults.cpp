// SPDX-License-Identifier: MIT
#include <filesystem>
#include <map>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/setup.hpp>

#include "caught.hpp"
#include "files/text_file.hpp"
#include "options/settle.hpp"

namespace defaults_test {

using namespace tactor;
using namespace tactor::options;

namespace {

setup read(const std::string& text)
{
    return parse_setup(text, "t.toml");
}

std::string complaint(const std::string& line)
{
    return caught_message([&] { static_cast<void>(read_defaults(read("[defaults]\n" + line + "\n"))); });
}

wishes settled(std::uint64_t place, const std::string& lines)
{
    wishes w;
    w.place = place;
    apply_defaults(w, read("[defaults]\n" + lines));
    settle(w);
    return w;
}

} // namespace

TEST_CASE("each option of [defaults] is read as it may be typed, and no other")
{
    const std::map<std::string, std::string> all{{"algorithm", "continuous"},
                                                 {"phantom", "log"},
                                                 {"faces", "nearest"},
                                                 {"min-duration", "0.01"},
                                                 {"speed", "70"},
                                                 {"soa", "0.06"},
                                                 {"burst", "0.07"},
                                                 {"timing", "fit"},
                                                 {"outside", "clamp"},
                                                 {"snap", "true"},
                                                 {"drop-points", "true"},
                                                 {"overlap", "sum"},
                                                 {"carrier", "230.5"},
                                                 {"waveform", "noise:1-300"},
                                                 {"am", "30:0.5"},
                                                 {"noise-seed", "9007199254740992"},
                                                 {"texture", "length"},
                                                 {"texture-mm", "12.5"},
                                                 {"envelope", "tukey:0.3"},
                                                 {"attack", "0.01"},
                                                 {"release", "0.02"},
                                                 {"phase", "burst"},
                                                 {"ramp", "0.005"},
                                                 {"sl", "7"},
                                                 {"intensity-scale", "sl"},
                                                 {"intensity-max", "255"},
                                                 {"stevens-exponent", "0.9"},
                                                 {"rate", "44100"},
                                                 {"sample-format", "s24-4"},
                                                 {"latency-ms", "17.3"},
                                                 {"slope", "0.31"},
                                                 {"intercept", "0.0471"},
                                                 {"compensate", "low-speed"},
                                                 {"observer", "low-speed"},
                                                 {"sigma-mm", "4"},
                                                 {"sigma-v-mm-s", "90"},
                                                 {"level-dbfs", "-6.5"}};
    std::size_t known = 0;
    for (const option& o : options::all()) {
        const std::string name = dashed(o);
        CAPTURE(name);
        if ((o.where & in_defaults) == 0) {
            CHECK(complaint(name + " = 1").find("unknown key '" + name + "' in [defaults]") !=
                  std::string::npos);
            continue;
        }
        ++known;
        REQUIRE(all.contains(name));
        const auto said = read_defaults(read(fmt::format("[defaults]\n{} = \"{}\"\n", name, all.at(name))));
        REQUIRE(said.size() == 1);
        CHECK(said.front().row == &o);
        // It lands where the row says, and changes what is built in.
        wishes w;
        w.place = o.where;
        apply_defaults(w, read(fmt::format("[defaults]\n{} = \"{}\"\n", name, all.at(name))));
        if (name != "speed") // it is only the usual one
            CHECK(o.to.get(w) != o.to.get(wishes()));
        CHECK(w.in_file.contains(index(o)));
    }
    CHECK(known == all.size());
}

TEST_CASE("a value of [defaults] that cannot be names its place")
{
    CHECK(complaint("phantoms = \"log\"") ==
          "t.toml:2:1: unknown key 'phantoms' in [defaults] (did you mean 'phantom'?)");
    CHECK(complaint("phantom = \"gauss\"") ==
          "t.toml:2:11: phantom: \"gauss\" is not known (did you mean gaussian? One of inverse-distance, "
          "barycentric, linear, log, gaussian)");
    CHECK(complaint("timing = 3") == "t.toml:2:10: timing: 3 is not known (one of fixed, fit)");
    CHECK(complaint("burst = nan") == "t.toml:2:9: burst: nan is out of range (0.0001 to 10 s)");
    CHECK(complaint("burst = \"0,07\"") ==
          "t.toml:2:9: burst: \"0,07\" is not a number (write a decimal point, as 0.07; 0.0001 to 10 s)");
    CHECK(complaint("rate = 44100.5") ==
          "t.toml:2:8: rate: 44100.5 is not a whole number (give one, as 44100)");
    CHECK(complaint("level-dbfs = 1") ==
          "t.toml:2:14: level-dbfs: 1 is out of range (did you mean -1? -200 to 0 dBFS)");
    CHECK(complaint("snap = 1") == "t.toml:2:8: snap: 1 is neither true nor false");
    CHECK(complaint("envelope = \"linear:0.3\"") ==
          "t.toml:2:12: envelope: \"linear:0.3\" is not known (only tukey has a part, 0 to 1, as tukey:0.5)");
    CHECK(complaint("waveform = 3") == "t.toml:2:12: waveform: 3 is no text (put it in quotes)");
    CHECK(complaint("am = 30") == "");
    CHECK(complaint("waveform = \"nowhere.wav\"") == ""); // looked for where it is used
    CHECK(caught_message([&] {
              static_cast<void>(read_defaults(read("defaults = { sl = 7, level-dbfs = -6 }\n")));
          }) == "t.toml:1:35: [defaults] has both sl and level-dbfs (keep one of them)");
    CHECK(complaint("level-dbfs = -6\nsl = 7") ==
          "t.toml:3:6: [defaults] has both level-dbfs and sl (keep one of them)");
}

TEST_CASE("what the user gives wins over [defaults], whatever comes first")
{
    for (const bool first : {true, false}) {
        wishes w;
        w.place = on_play;
        const setup says = read("[defaults]\nsl = 7\nspeed = 20\nlatency-ms = 40\nsoa = 0.06\n");
        if (!first)
            apply_defaults(w, says);
        give(w, *find("level-dbfs"), -20.0);
        give(w, *find("duration"), 2.0);
        give(w, *find("period_frames"), 48.0);
        if (first)
            apply_defaults(w, says);
        settle(w);
        CHECK_FALSE(w.render.sl_db);
        CHECK(w.render.level_dbfs == -20.0);
        CHECK_FALSE(w.speed_mm_s);
        CHECK_FALSE(w.usual_speed_mm_s);
        CHECK_FALSE(w.stream.latency_ms);
        CHECK(w.plan.soa_s == 0.06);
    }
}

TEST_CASE("a speed of [defaults] is one of strokes that say none")
{
    const wishes w = settled(on_play, "speed = 20\n");
    CHECK(w.usual_speed_mm_s == 20.0);
    CHECK_FALSE(w.speed_mm_s);
}

TEST_CASE("a place takes only the options that it has")
{
    CHECK(settled(on_calibrate, "soa = 0.06\ncarrier = 100\n").plan.soa_s == 0.07);
    CHECK(settled(on_calibrate, "carrier = 100\n").plan.carrier_hz == 100.0);
    CHECK(settled(in_player, "rate = 44100\nsample-format = \"s16\"\n").rate == 44100u);
}

TEST_CASE("values of [defaults] that nothing uses may stand there for other strokes")
{
    CHECK(settled(on_plan, "noise-seed = 3\nsigma-mm = 4\n").plan.wave.seed == 3);
    wishes w;
    w.place = on_plan;
    give(w, *find("noise_seed"), 3.0);
    CHECK(caught_message([&] { settle(w); }) ==
          "noise_seed: nothing here uses it (add waveform = noise:LO-HI)");
}

TEST_CASE("an error about a value of [defaults] has its place in the file")
{
    const wishes w = settled(on_plan, "soa = 0.5\n");
    const error e = error(error_kind::bad_input, "soa_s", "it is too long", "use 0.07").with_field("soa_s");
    CHECK(std::string(at_default(w, e).what()) == "t.toml:2:7: soa: it is too long (use 0.07)");
    const error other = error(error_kind::bad_input, "burst_s", "no", "").with_field("burst_s");
    CHECK(std::string(at_default(w, other).what()) == "burst_s: no");
}

TEST_CASE("the manual page names every option that [defaults] takes")
{
    const auto source = std::filesystem::path(TACTOR_SOURCE_ROOT);
    const std::string page(std::string_view(detail::read_text_file(source / "man/tactor.toml.5", 1 << 20)));
    for (const option& o : options::all()) {
        const std::string name = dashed(o);
        CAPTURE(name);
        if ((o.where & in_defaults) != 0)
            CHECK(page.find(fmt::format("\n{}\t", name)) != std::string::npos);
    }
}

} // namespace defaults_test
