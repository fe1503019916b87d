// SPDX-License-Identifier: MIT
// The table of options, their spelling, and [defaults].
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/setup.hpp>

#include "caught.hpp"
#include "core/marks.hpp"
#include "files/text_file.hpp"
#include "options/option.hpp"
#include "options/resolve.hpp"

namespace options_test {

using namespace tactor;
using namespace tactor::options;

namespace {

bool is_number(const option& o)
{
    return o.what == kind::number || o.what == kind::whole;
}

option_values with(std::uint64_t place, std::initializer_list<std::pair<const char*, value>> given)
{
    option_values w;
    w.place = place;
    for (const auto& [name, v] : given)
        give(w, *find(name), v);
    return w;
}

std::string bracketed(const option& o, std::string_view value)
{
    return fmt::format("<{}{}{}>", o.name, value.empty() ? "" : ":", value);
}

std::string speech(std::string_view text)
{
    return spell(text, {bracketed});
}

setup read(const std::string& text)
{
    return parse_setup(text, "t.toml");
}

std::string complaint(const std::string& line)
{
    return caught_message([&] { static_cast<void>(read_defaults(read("[defaults]\n" + line + "\n"))); });
}

option_values settled(std::uint64_t place, const std::string& lines)
{
    option_values w;
    w.place = place;
    apply_defaults(w, read("[defaults]\n" + lines));
    resolve(w);
    return w;
}

} // namespace

TEST_CASE("each row has all its fields")
{
    std::set<std::string_view> names;
    for (const option& o : all()) {
        CAPTURE(o.name);
        CHECK(names.insert(o.name).second);
        CHECK(find(o.name) == &o);
        CHECK(find(o.field_name()) == &o);
        CHECK_FALSE(o.help.empty());
        CHECK(o.where != 0);
        CHECK((o.to.set != nullptr && o.to.get != nullptr));
        CHECK((o.what == kind::choice) <= (o.choices != nullptr));
        CHECK(is_number(o) <= (o.allowed.low < o.allowed.high));
        CHECK((o.used == nullptr) == o.needs.empty());
        if (!o.rival.empty()) {
            REQUIRE(find(o.rival) != nullptr);
            CHECK(find(o.rival)->rival == o.name);
        }
        // Marks name rows.
        CHECK(speech(o.needs).find('{') == std::string::npos);
        CHECK(speech(o.range).find('{') == std::string::npos);
    }
}

TEST_CASE("each number ends at its bounds, typed and as a value, and comes back")
{
    for (const option& o : all()) {
        if (!is_number(o))
            continue;
        CAPTURE(o.name);
        for (const double v : {o.allowed.low, o.allowed.high}) {
            option_values w;
            put(w, o, read_value(o, v));
            CHECK(std::get<double>(o.to.get(w)) == v);
            CHECK(std::get<double>(read_text(o, fmt::format("{}", v))) == v);
        }
        const double below = std::nextafter(o.allowed.low, -1e300);
        const double above = std::nextafter(o.allowed.high, 1e300);
        for (const double v : {below, above, std::nan(""), double(INFINITY)}) {
            const std::string said = caught_message([&] { static_cast<void>(read_value(o, v)); });
            CHECK(said.starts_with(fmt::format("{}: ", o.name)));
            CHECK(said.find(" is out of range (" + sign_hint(o.allowed, v) + detail::plain(range_text(o)) +
                            ")") != std::string::npos);
            CHECK_THROWS_AS(read_text(o, fmt::format("{}", v)), error);
        }
        if (o.what == kind::whole)
            CHECK_THROWS_AS(read_value(o, o.allowed.low + 0.5), error);
        CHECK_THROWS_AS(read_value(o, true), error);
        CHECK_THROWS_AS(read_value(o, "1"), error);
        CHECK_THROWS_AS(read_value(o, value()), error);
    }
}

TEST_CASE("each choice and flag comes back, and no other word is accepted")
{
    for (const option& o : all()) {
        CAPTURE(o.name);
        if (o.what == kind::choice)
            for (const std::string_view name : o.choices()) {
                option_values w;
                put(w, o, read_text(o, std::string(name)));
                CHECK(std::get<std::string>(o.to.get(w)) == name);
            }
        if (o.what == kind::flag) {
            option_values w;
            put(w, o, read_text(o, "true"));
            CHECK(std::get<bool>(o.to.get(w)));
        }
        if (o.what == kind::choice || o.what == kind::flag) {
            CHECK_THROWS_AS(read_text(o, "nonsense"), error);
            CHECK_THROWS_AS(read_value(o, 1.0), error);
        }
    }
}

TEST_CASE("two exclusive options are refused in any order")
{
    for (const option& o : all()) {
        if (o.rival.empty())
            continue;
        CAPTURE(o.name);
        option_values w;
        give(w, *find(o.rival), find(o.rival)->allowed.low);
        CHECK(caught_message([&] { give(w, o, o.allowed.low); }) ==
              fmt::format("{}: it cannot be combined with {{{}}} (give one of them)", o.name, o.rival));
    }
}

TEST_CASE("an unused option is refused with a hint for its place")
{
    const auto said = [](std::uint64_t place, std::initializer_list<std::pair<const char*, value>> given) {
        option_values w = with(place, given);
        return caught_message([&] { resolve(w); });
    };
    CHECK(said(on_plan, {{"sigma_mm", 3.0}}) ==
          "sigma_mm: nothing here uses it (add compensate = low-speed)");
    CHECK(said(on_compare, {{"sigma_mm", 3.0}}) ==
          "sigma_mm: nothing here uses it (add observer = low-speed or compensate = low-speed)");
    CHECK(said(on_plan, {{"sigma_mm", 3.0}, {"compensate", "low-speed"}}) == "");
    CHECK(said(by_client, {{"stevens_exponent", 0.9}}) ==
          "stevens_exponent: nothing here uses it (add intensity_scale = stevens)");
    CHECK(said(by_client, {{"ramp", 0.1}, {"envelope", "tukey"}}) ==
          "ramp: {envelope=tukey} has its own ramps (leave out ramp or envelope)");
    CHECK(said(on_plan, {{"intensity_scale", "sl"}}) ==
          "intensity_scale: the scale sl needs a sensation level above 0 dB (add sl, such as sl = 7)");
    CHECK(said(on_plan, {{"fit_margin", 1.0}}) == "fit_margin: nothing here uses it (add fit_strokes())");
}

TEST_CASE("a user's timing law has its own longest SOA")
{
    option_values w = with(on_plan, {{"slope", 0.3}, {"intercept", 0.04}});
    resolve(w);
    CHECK(w.plan.profile.max_soa_s == doctest::Approx(0.04 / 0.7));
    for (const auto& said :
         {std::pair("soa", 0.06), std::pair("slope", 0.32), std::pair("intercept", 0.0473)}) {
        option_values usual = with(on_plan, {said});
        resolve(usual);
        CHECK(usual.plan.profile.max_soa_s == 0.07);
    }
}

TEST_CASE("marks are spelled, other braces stay")
{
    CHECK(speech("use {timing=fit} or {soa_s}, {nothing} { x }") ==
          "use <timing:fit> or <soa>, {nothing} { x }");
    CHECK(speech("{") == "{");
    CHECK(speech("") == "");
}

TEST_CASE("a front end uses its own words, and leaves out what it lacks")
{
    constexpr std::array own{own_word{"fit=true", ""}, own_word{"array", "<array:{}>"},
                             own_word{"at_ns", "<at>"}};
    const spelling client{bracketed, by_client, own};
    CHECK(spell("{array=a b| is another, }{fit=true| scales it, }or {outside=clamp}", client) ==
          "<array:a b> is another, or <outside:clamp>");
    CHECK(spell("lower {max_drive_s} or {soa}", client) == "lower max_drive_s or <soa>"); // no client has it
    CHECK(spell("{command:devices} lists all", client) == "tactor devices lists all");
    CHECK(spell("{soa_s}, {sl_db}, {phantom=log}", client, true) == "soa_s, <sl>, phantom = log");
    CHECK(spell_field("at_ns", client) == "<at>");
    CHECK(spell_field("soa_s", client) == "<soa>");
    CHECK(spell_field("gain_db", client) == "gain_db");
    CHECK(spell_field("", client).empty());
}

TEST_CASE("an error about a field names the option, unless it is about a key of a file")
{
    const auto said = [](const error& e) {
        const error once = spell(e, {bracketed});
        CHECK(std::string(spell(once, {bracketed}).what()) == once.what());
        return std::string(once.what());
    };
    const auto about = [](const char* what) { return error(error_kind::bad_input, what, "no", "{soa_s}"); };
    CHECK(said(about("soa_s").with_field("soa_s")) == "<soa>: no (<soa>)");
    CHECK(said(about("{timing=fit}").with_field("min_duration_s")) == "<timing:fit>: no (<soa>)");
    CHECK(said(about("path")) == "path: no (<soa>)"); // not the option
    CHECK(said(about("soa_s.toml")) == "soa_s.toml: no (<soa>)");
    CHECK(said(error(error_kind::bad_input, source_place{"s.toml", 3, 1}, "no", "{soa_s} or {sl_db}")
                   .with_field("soa_s")) == "s.toml:3:1: no (soa_s or <sl>)");
}

TEST_CASE("options of planning are refused beside a plan")
{
    for (const option& o : all()) {
        option_values w;
        w.by_user.set(index(o));
        CAPTURE(o.name);
        const bool refused = !caught_message([&] { refuse_planning_options(w, "p.json"); }).empty();
        CHECK(refused == ((o.where & planning) != 0));
    }
}

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
                                                 {"together", "sum"},
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
                                                 {"spread-seed", "7"},
                                                 {"no-desktop", "true"},
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
        option_values w;
        w.place = o.where;
        apply_defaults(w, read(fmt::format("[defaults]\n{} = \"{}\"\n", name, all.at(name))));
        if (name != "speed") // it is only the usual one
            CHECK(o.to.get(w) != o.to.get(option_values()));
        CHECK(w.in_file.contains(index(o)));
    }
    CHECK(known == all.size());
}

TEST_CASE("a value of [defaults] that cannot be names its place")
{
    CHECK(complaint("phantoms = \"log\"") ==
          "t.toml:2:1: unknown key 'phantoms' in [defaults] (did you mean 'phantom'?)");
    CHECK(complaint("phantom = \"gauss\"") ==
          "t.toml:2:11: phantom: \"gauss\" is unknown (did you mean gaussian? Use one of inverse-distance, "
          "barycentric, linear, log, gaussian)");
    CHECK(complaint("timing = 3") == "t.toml:2:10: timing: 3 is unknown (use one of fixed, fit)");
    CHECK(complaint("burst = nan") == "t.toml:2:9: burst: nan is out of range (use 0.0001 to 10 s)");
    CHECK(complaint("burst = \"0,07\"") == "t.toml:2:9: burst: \"0,07\" is not a number (write a "
                                           "decimal point, as in 0.07; use 0.0001 to 10 s)");
    CHECK(complaint("rate = 44100.5") ==
          "t.toml:2:8: rate: 44100.5 is not a whole number (give a whole number, such as 44100)");
    CHECK(complaint("level-dbfs = 1") ==
          "t.toml:2:14: level-dbfs: 1 is out of range (did you mean -1? Use -200 to 0 dBFS)");
    CHECK(complaint("snap = 1") == "t.toml:2:8: snap: 1 is neither true nor false");
    CHECK(complaint("envelope = \"linear:0.3\"") ==
          "t.toml:2:12: envelope: linear takes no number after a colon (write linear, or tukey with "
          "a number, such as tukey:0.5)");
    CHECK(complaint("waveform = 3") == "t.toml:2:12: waveform: 3 is not a text (put it in quotes)");
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
        option_values w;
        w.place = on_play;
        const setup says = read("[defaults]\nsl = 7\nspeed = 20\nlatency-ms = 40\nsoa = 0.06\n");
        if (!first)
            apply_defaults(w, says);
        give(w, *find("level-dbfs"), -20.0);
        give(w, *find("duration"), 2.0);
        give(w, *find("period_frames"), 48.0);
        if (first)
            apply_defaults(w, says);
        resolve(w);
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
    const option_values w = settled(on_play, "speed = 20\n");
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
    option_values w;
    w.place = on_plan;
    give(w, *find("noise_seed"), 3.0);
    CHECK(caught_message([&] { resolve(w); }) ==
          "noise_seed: nothing here uses it (add waveform = noise:LO-HI)");
}

TEST_CASE("an error about a value of [defaults] has its place in the file")
{
    const option_values w = settled(on_plan, "soa = 0.5\n");
    const error e = error(error_kind::bad_input, "soa_s", "it is too long", "use 0.07").with_field("soa_s");
    CHECK(std::string(locate_default_error(w, e).what()) == "t.toml:2:7: soa: it is too long (use 0.07)");
    const error other = error(error_kind::bad_input, "burst_s", "no", "").with_field("burst_s");
    CHECK(std::string(locate_default_error(w, other).what()) == "burst_s: no");
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

} // namespace options_test
