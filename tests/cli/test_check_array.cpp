// SPDX-License-Identifier: MIT
// Findings of `check` about arrays, levels and actuators.
#include "cli/check/check.hpp"

#include <algorithm>
#include <utility>

#include <doctest/doctest.h>

#include "has.hpp"

namespace check_array_test {

using namespace tactor;
using namespace tactor::cli;

namespace {

const finding& named(const std::vector<finding>& all, const std::string& check)
{
    const auto f = std::find_if(all.begin(), all.end(), [&](const finding& x) { return x.check == check; });
    REQUIRE_MESSAGE(f != all.end(), check);
    return *f;
}

finding array_finding(const array& a, const std::string& check, const settings& s = {})
{
    environment e;
    e.tactors = a;
    return named(check_array(s, e), check);
}

finding limits_finding(const limit_settings& l, array a = preset_array("palm-3x3"))
{
    environment e;
    e.tactors = std::move(a);
    e.config.limits = l;
    return named(check_array({}, e), "limits");
}

array with_actuator(actuator_kind kind)
{
    array a = preset_array("palm-3x3");
    for (tactor_spec& t : a.tactors)
        t.actuator = kind;
    return a;
}

finding bursts(actuator_kind kind, const std::string& check, double carrier_hz = 250.0,
               algorithm_kind method = algorithm_kind::park2016)
{
    plan_options p;
    p.carrier_hz = carrier_hz;
    p.algorithm = method;
    return named(check_bursts(p, with_actuator(kind), 48000), check);
}

} // namespace

TEST_CASE("for an array as large as a trunk check cites the knowledge about trunks")
{
    const finding vest = array_finding(make_grid("vest", 4, 5, 50.0, 50.0), "array");
    CHECK(vest.how == level::ok);
    CHECK(vest.cure.find("twice as well across as along") != std::string::npos);
    CHECK(vest.cure.find("--phantom linear") != std::string::npos);
    CHECK(array_finding(make_grid("sleeve", 2, 5, 50.0, 50.0), "array").cure.empty());
}

TEST_CASE("check lists places: number, grid, size, distances")
{
    const finding palm = array_finding(preset_array("palm-3x3"), "array");
    CHECK(palm.how == level::ok);
    CHECK(palm.found == "palm-3x3: 9 tactors, 3 x 3, 40 x 40 mm, neighbours 20 mm apart");
    array ragged = preset_array("palm-2x4");
    ragged.tactors[7].position.x_mm += 5.0;
    CHECK(array_finding(ragged, "array").found ==
          "palm-2x4: 8 tactors, no grid, 65 x 20 mm, neighbours 20 to 20.62 mm apart");
}

TEST_CASE("an array that is not in millimetres, or has one tactor, is a warning")
{
    CHECK(array_finding(make_grid("m", 3, 3, 0.02, 0.02), "array").how == level::warning);
    CHECK(array_finding(make_grid("um", 2, 2, 20000.0, 20000.0), "array").how == level::warning);
    CHECK(array_finding(make_grid("one", 1, 1, 20.0, 20.0), "array").how == level::warning);
    CHECK(array_finding(make_grid("arm", 1, 4, 60.0, 60.0), "array").how == level::ok);
}

TEST_CASE("nearest neighbours are found in any order of the file")
{
    array a = make_grid("many", 25, 40, 10.0, 7.0);
    std::reverse(a.tactors.begin() + 100, a.tactors.end());
    CHECK(has(array_finding(a, "array").found, "neighbours 7 mm apart"));
}

TEST_CASE("check lists channels and the marker")
{
    environment e;
    e.tactors = preset_array("palm-3x3");
    CHECK(named(check_array({}, e), "channels").found == "9 of 9 channels drive tactors: 0 to 8");
    e.tactors.tactors[8].channel = 12;
    e.config.output.channels = 16;
    e.config.sync.emplace();
    e.config.sync->channel = 15;
    CHECK(named(check_array({}, e), "channels").found ==
          "9 of 16 channels drive tactors: 0, 1, 2, 3, 4, 5, 6, 7, 12; 15 marks strokes");
}

TEST_CASE("levels that play would refuse are errors in the same words")
{
    array a = preset_array("palm-3x3");
    CHECK(array_finding(a, "levels").found == "peaks of -12 dBFS");
    a.tactors[3].gain_db = -6.0;
    CHECK(array_finding(a, "levels").found == "peaks of -18 to -12 dBFS");
    a.tactors[3].gain_db = 13.0;
    const finding over = array_finding(a, "levels");
    CHECK(over.how == level::error);
    CHECK(over.kind == error_kind::bad_input);
    CHECK(has(over.found, "tactor 3"));
    CHECK_FALSE(over.cure.empty());
}

TEST_CASE("missing thresholds, and levels that are not above them, are findings")
{
    array a = preset_array("palm-3x3");
    settings sl;
    sl.render.sl_db = 7.0;
    CHECK(array_finding(a, "levels", sl).how == level::error);
    for (tactor_spec& t : a.tactors)
        t.threshold_dbfs = -40.0;
    CHECK(array_finding(a, "levels", sl).found == "peaks of -33 dBFS, 7 dB SL");
    CHECK(array_finding(a, "levels").how == level::ok);
    a.tactors[2].threshold_dbfs = -10.0;
    const finding unfelt = array_finding(a, "levels");
    CHECK(unfelt.how == level::warning);
    CHECK(has(unfelt.found, "not above the threshold of tactors 2"));
    a.tactors[2].threshold_dbfs.reset();
    CHECK(has(array_finding(a, "levels").found, "no threshold of tactors 2"));
}

TEST_CASE("check lists the limits that hold")
{
    const finding usual = array_finding(preset_array("palm-3x3"), "limits");
    CHECK(usual.how == level::ok);
    CHECK(usual.found == "all together at most +4.77 dB of one at full scale; each at most 5 s in 10 s");
    CHECK(limits_finding({.power_dbfs = 0.0, .max_drive_s = 2.0, .window_s = 4.0}).how == level::ok);
}

TEST_CASE("a limit that is weaker than by default is a warning that gives the default")
{
    const finding untimed = limits_finding({.power_dbfs = 0.0, .max_drive_s = 20.0});
    CHECK(untimed.how == level::warning);
    CHECK(untimed.found ==
          "all together at most +0 dB of one at full scale; no limit on time: more than by default");
    CHECK(has(untimed.cure, "max_drive_s = 5, window_s = 10"));
    CHECK(untimed.cure.find("power_dbfs") == std::string::npos);
    for (const limit_settings& l :
         {limit_settings{.window_s = 5.0}, limit_settings{.window_s = 9.0}, limit_settings{.window_s = 1.0},
          limit_settings{.max_drive_s = 3600.0}, limit_settings{.max_drive_s = 60.0, .window_s = 3600.0}})
        CHECK(limits_finding(l).how == level::warning);
    const finding loud = limits_finding({.power_dbfs = 60.0});
    CHECK(loud.how == level::warning);
    CHECK(has(loud.cure, "power_dbfs = 4.77"));
    CHECK(loud.cure.find("window_s") == std::string::npos);
    CHECK(limits_finding({.power_dbfs = 60.0, .max_drive_s = 60.0}).how == level::warning);
    // The default lets three tactors through: for them it is no limit either.
    CHECK(limits_finding({.power_dbfs = 60.0}, make_grid("three", 1, 3, 20.0, 20.0)).how == level::ok);
}

TEST_CASE("actuators that cannot make the bursts are a warning with the reason")
{
    CHECK(bursts(actuator_kind::piezo, "actuators").how == level::ok);
    CHECK(bursts(actuator_kind::voice_coil, "actuators").found == "voice-coil");
    const finding erm = bursts(actuator_kind::erm, "actuators");
    CHECK(erm.how == level::warning);
    CHECK(has(erm.found, "116 ms"));
    CHECK(has(erm.found, "bursts of 70 ms"));
    const finding lra = bursts(actuator_kind::lra, "actuators", 175.0);
    CHECK(lra.how == level::warning);
    CHECK(has(lra.found, "the carrier is 175 Hz"));
    CHECK(has(lra.cure, "--carrier"));
    CHECK(has(bursts(actuator_kind::lra, "actuators", 250.0, algorithm_kind::continuous).found,
              "a moving phantom"));
    const finding unknown = bursts(actuator_kind::unknown, "actuators");
    CHECK(unknown.how == level::ok);
    CHECK(has(unknown.cure, "actuator = "));
}

TEST_CASE("the unsuitable ones of mixed actuators are named")
{
    array a = with_actuator(actuator_kind::piezo);
    a.tactors[4].actuator = actuator_kind::erm;
    a.tactors[7].actuator = actuator_kind::lra;
    const auto all = check_bursts({}, a, 48000);
    CHECK(all.size() == 3);
    CHECK(has(all[0].found, "tactor 4: an ERM"));
    CHECK(has(all[1].found, "tactor 7: an LRA"));
    a.tactors[7].actuator = a.tactors[4].actuator = actuator_kind::voice_coil;
    CHECK(named(check_bursts({}, a, 48000), "actuators").found == "7 piezo, 2 voice-coil");
}

TEST_CASE("carriers are checked against skin, burst and rate")
{
    CHECK(bursts(actuator_kind::piezo, "bursts").found == "70 ms at 250 Hz, 17.5 cycles");
    CHECK(bursts(actuator_kind::piezo, "bursts", 60.0).how == level::warning);
    CHECK(has(bursts(actuator_kind::piezo, "bursts", 60.0).found, "too few"));
    CHECK(bursts(actuator_kind::piezo, "bursts", 60.0, algorithm_kind::continuous).how == level::ok);
    CHECK(bursts(actuator_kind::piezo, "bursts", 20.0).how == level::warning);
    CHECK(bursts(actuator_kind::piezo, "bursts", 1500.0).how == level::warning);
    const finding alias = bursts(actuator_kind::piezo, "bursts", 24000.0);
    CHECK(alias.how == level::error);
    CHECK(alias.kind == error_kind::bad_input);
}

TEST_CASE("an impossible SOA or algorithm is an error")
{
    plan_options p;
    p.soa_s = 0.2;
    CHECK(named(check_bursts(p, with_actuator(actuator_kind::piezo), 48000), "bursts").how == level::error);
    p = {};
    p.algorithm = algorithm_kind::tactile_brush;
    array a = with_actuator(actuator_kind::piezo);
    CHECK(named(check_bursts(p, a, 48000), "bursts").how == level::ok);
    a.tactors[0].position.x_mm -= 3.0;
    CHECK(has(named(check_bursts(p, a, 48000), "bursts").found, "grid"));
}

} // namespace check_array_test
