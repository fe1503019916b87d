// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/render.hpp>

#include "options/option.hpp"
#include "server/faults.hpp"
#include "server/params.hpp"
#include "server/request.hpp"
#include "server/service.hpp"

namespace request_test {

using namespace tactor;
using namespace tactor::server;
using net::json;

namespace {

template <typename F>
net::rpc_fault fault_from(F make)
{
    try {
        make();
    } catch (...) {
        return current_fault("params");
    }
    FAIL("nothing was refused");
    return {};
}

// Checks the parameters of the method plan.
void check_plan(const json& params)
{
    for (const service::method& m : service::methods())
        if (m.name == std::string("plan"))
            check_param(m.params, params);
}

planning palm()
{
    planning p;
    p.tactors = preset_array("palm-3x3");
    return p;
}

// Checks, reads and plans, with the options settled first, as the service does.
planned plan_request(
    const planning& with, const layout& faces, const json& params, const go_on_check& go_on = [] {})
{
    check_plan(params);
    return server::plan_request(with, faces, params, resolve_options(with.owner, params), go_on);
}

net::rpc_fault plan_fault(const json& params)
{
    const planning p = palm();
    return fault_from([&] { plan_request(p, layout(p.tactors), params); });
}

std::string fault_what(const json& params)
{
    return plan_fault(params).what;
}

} // namespace

TEST_CASE("the options that a client may give are listed with bounds, choices and the owner's values")
{
    options::option_values owner;
    owner.render.level_dbfs = -20.0;
    owner.plan.timing = timing_kind::fit;
    std::map<std::string, json> rows;
    for (const auto& row : option_rows(owner))
        rows[row["name"]] = json(row);
    for (const options::option& o : options::all()) {
        CAPTURE(o.name);
        const bool listed = rows.contains(std::string(o.name));
        CHECK(listed == ((o.where & options::by_client) != 0));
        if (!listed)
            continue;
        const json& row = rows.at(std::string(o.name));
        CHECK(row.size() == 11);
        CHECK(row["help"].get<std::string>().find('{') == std::string::npos);
        if (!row["default"].is_null() && o.used == nullptr) // a client may give it back
            CHECK_NOTHROW(replace_options({}, {{o.name, row["default"]}}, options_for::planned));
    }
    CHECK(rows["soa"] ==
          json{{"name", "soa"},
               {"key", "soa_s"},
               {"group", "Timing"},
               {"kind", "number"},
               {"unit", "s"},
               {"least", nullptr},
               {"most", nullptr}, // the timing law's
               {"choices", json::array()},
               {"default", 0.07},
               {"live", true},
               {"help", "time from the onset of a burst to the onset of the next (default 0.07)"}});
    CHECK(rows["level_dbfs"]["default"] == -20.0);
    CHECK(rows["level_dbfs"]["key"].is_null());
    CHECK(rows["level_dbfs"]["least"] == -200.0);
    CHECK(rows["level_dbfs"]["most"] == 0.0);
    CHECK(rows["timing"]["choices"] == json{"fixed", "fit"});
    CHECK(rows["timing"]["default"] == "fit");
    CHECK(rows["timing"]["live"] == false);
    CHECK(rows["snap"]["kind"] == "flag");
    CHECK(rows["snap"]["default"] == false);
    CHECK(rows["noise_seed"]["kind"] == "whole");
    CHECK(rows["noise_seed"]["default"].is_number_integer());
    CHECK(rows["duration"]["default"].is_null());
    CHECK(rows["attack"]["help"] == "time in which each burst rises (default: options.ramp)");
}

TEST_CASE("options are put over the owner's; tests/options has each of them")
{
    options::option_values owner;
    owner.speed_mm_s = 80.0;
    owner.render.sl_db = 7.0;
    const options::option_values s = replace_options(owner,
                                                     {{"phantom", "log"},
                                                      {"duration", 2},
                                                      {"slope", 0.3},
                                                      {"intercept", 0.04},
                                                      {"snap", true},
                                                      {"waveform", "noise:50-300"},
                                                      {"noise_seed", 5},
                                                      {"am", "20:0.5"},
                                                      {"level_dbfs", -20}},
                                                     options_for::planned);
    CHECK(s.plan.phantom == from_string<phantom_kind>("log"));
    CHECK(s.duration_s == 2.0);
    CHECK_FALSE(s.speed_mm_s);
    CHECK(s.plan.profile.max_soa_s == doctest::Approx(0.04 / 0.7));
    CHECK(s.plan.snap);
    CHECK(s.plan.wave.seed == 5);
    CHECK(s.plan.am == modulation{20.0, 0.5});
    CHECK(s.render.level_dbfs == -20.0);
    CHECK_FALSE(s.render.sl_db);
}

TEST_CASE("what is refused names its parameter")
{
    const json path{{"path", "M 0 0 L 40 40"}};
    const auto option = [&](const char* name, const json& value) {
        json p = path;
        p["options"] = {{name, value}};
        return fault_what(p);
    };
    for (const char* name : {"soa", "burst", "slope", "carrier", "ramp", "level_dbfs", "sl", "duration"}) {
        CHECK(option(name, "1") == std::string("options.") + name);
        CHECK(option(name, 1e300) == std::string("options.") + name);
        CHECK(option(name, nullptr) == std::string("options.") + name);
    }
    CHECK(option("soa", 0.5) == "options.soa");
    CHECK(option("soa", 0.01) == "options.soa");
    CHECK(option("burst", 0.5) == "options.burst");
    CHECK(option("carrier", 100000) == "options.carrier");
    CHECK(option("max_drive_s", 1) == "options.max_drive_s");
    for (const char* wave : {"sqare", "./grain.wav", "/dev/zero", "noise:./x.wav", "noise:50-30000", ""})
        CHECK(option("waveform", wave) == "options.waveform");
    CHECK(option("noise_seed", 1.5) == "options.noise_seed");
    CHECK(option("am", "x") == "options.am");
    CHECK(option("envelope", "tukey:2") == "options.envelope");
    CHECK(option("envelope", "linear:0.5") == "options.envelope");
    CHECK(option("intensity_scale", "sl") == "options.intensity_scale");
    CHECK(fault_what({{"path", "M 0 0 L 400 0"}}) == "path");
    CHECK(fault_what({{"toml", "stroke"}}) == "toml");
    CHECK(fault_what({{"csv", "t_s,x_mm,y_mm\n0,0,0\n"}}) == "csv");
    const net::rpc_fault f = plan_fault({{"toml", "\n[stroke]\nx = 1\n"}});
    CHECK(f.what == "toml");
    CHECK(f.line == 3);
    CHECK(f.column == 1);
}

TEST_CASE("parameters of a view that are refused name themselves")
{
    const auto fault = [](json params) {
        params["stroke"] = "park2016-1";
        return fault_from([&] {
            check_plan(params);
            resolve_options({}, params);
        });
    };
    CHECK(fault({{"view", "all"}}).what == "view");
    CHECK(fault({{"view", 1}}).what == "view");
    for (const json& bins : {json(0), json(4001), json(1.5), json("9"), json(nullptr)})
        CHECK(fault({{"view", "peaks"}, {"bins", bins}}).what == "bins");
    CHECK(fault({{"view", "percept"}, {"bins", 9}}).what == "bins");
    CHECK(fault({{"bins", 9}}).what == "bins");
    CHECK(fault({{"observer", "centroid"}}).what == "observer");
    CHECK(fault({{"view", "bursts"}, {"observer", "centroid"}}).what == "observer");
    CHECK(fault({{"view", "percept"}, {"observer", "me"}}).what == "observer");
    CHECK(fault({{"view", "percept"}, {"observer", "me"}}).hint == "use one of centroid, low-speed");
    CHECK(fault({{"view", "percept"}, {"options", {{"sigma_mm", 3}}}}).what == "options.sigma_mm");
    CHECK(fault({{"options", {{"sigma_mm", 9}}}}).what == "options.sigma_mm"); // which nothing uses
}

TEST_CASE("bursts are moved for the low-speed observer where it is asked for")
{
    planning p = palm();
    const layout faces(p.tactors);
    json params{{"stroke", "park2016-3"},
                {"options", {{"compensate", "low-speed"}, {"sigma_mm", 8}, {"phantom", "barycentric"}}}};
    plan_options o;
    o.phantom = phantom_kind::barycentric;
    const compensated_plan wanted =
        make_compensated_plan(p.tactors, faces, preset_stroke("park2016-3"), o, {.sigma_mm = 8.0});
    const planned made = plan_request(p, faces, params);
    REQUIRE(made.moved.size() == 1);
    CHECK(made.plans.front().plan == wanted.plan);
    CHECK(made.moved.front().taps == wanted.taps);
    CHECK(made.warnings() == wanted.plan.warnings);

    // The owner's configuration may ask for it; a client may not want it.
    p.owner.compensate = true;
    CHECK(plan_request(p, faces, {{"stroke", "park2016-3"}}).moved.size() == 1);
    CHECK(plan_request(p, faces, {{"stroke", "park2016-3"}, {"options", {{"compensate", "none"}}}})
              .moved.empty());
    p.owner.compensate = false;

    const auto refused = [&](const char* name, const json& value) {
        return fault_what({{"stroke", "park2016-3"}, {"options", {{name, value}}}});
    };
    CHECK(refused("compensate", "lowspeed") == "options.compensate");
    CHECK(refused("compensate", true) == "options.compensate");
    CHECK(refused("sigma_mm", 8) == "options.sigma_mm");
    CHECK(refused("sigma_v_mm_s", 8) == "options.sigma_v_mm_s");
    params["options"]["algorithm"] = "continuous";
    CHECK(fault_what(params) == "options.algorithm");
    params["options"]["algorithm"] = "park2016";
    params["options"]["sigma_mm"] = 1e6;
    CHECK(fault_what(params) == "options.sigma_mm");
    CHECK(fault_from([&] {
              replace_options({}, {{"compensate", "low-speed"}}, options_for::live);
          }).what == "options.compensate");
}

TEST_CASE("a hint names what a request can say")
{
    CHECK(plan_fault({{"toml", "[array]\npreset = \"palm-3x3\"\n"}}).hint ==
          "give it as an array or a configuration of the server");
    const json outside{{"path", "M 0 0 L 400 0"}, {"options", {{"algorithm", "continuous"}}}};
    CHECK(plan_fault(outside).hint.find("options.outside") != std::string::npos);
    CHECK(plan_fault({{"stroke", "wave-2x4"}}).hint ==
          "use palm-2x4, or options.outside clamp to play the nearest point of the array");
}

TEST_CASE("faces are those that are asked for, and go with inverse-distance alone")
{
    const planning p = palm();
    const layout l(p.tactors);
    const auto with_faces = [](const char* phantom) {
        return json{{"stroke", "park2016-1"}, {"options", {{"faces", "nearest"}, {"phantom", phantom}}}};
    };
    const planned made = plan_request(p, l, with_faces("inverse-distance"));
    const plan_options o{.faces = faces_kind::nearest};
    CHECK(made.plans.front().plan == make_plan(p.tactors, preset_stroke("park2016-1"), o));
    CHECK(fault_what(with_faces("log")) == "options.faces");
    CHECK(fault_what({{"stroke", "park2016-1"}, {"options", {{"faces", "neerest"}}}}) == "options.faces");
    CHECK(plan_fault(with_faces("log")).hint ==
          "use options.faces delaunay or options.phantom inverse-distance");
    CHECK(replace_options({}, {{"faces", "nearest"}}, options_for::live).plan.faces == faces_kind::nearest);
}

TEST_CASE("how many strokes, and how long together, is refused before any is planned")
{
    planning p = palm();
    p.max_strokes = 3;
    const auto strokes = [](std::size_t n, double seconds) {
        std::string toml;
        for (std::size_t i = 0; i < n; ++i)
            toml +=
                "[[stroke]]\npath = 'M 0 0 L 40 40'\nstart_s = 0\nduration_s = " + std::to_string(seconds) +
                "\n";
        return json{{"toml", toml}, {"options", {{"algorithm", "continuous"}}}};
    };
    std::size_t planned_ones = 0;
    const auto refused = [&](const json& params) {
        planned_ones = 0;
        const auto f =
            fault_from([&] { plan_request(p, layout(p.tactors), params, [&] { ++planned_ones; }); });
        CHECK(f.code == net::code_limit);
        CHECK(planned_ones == 0);
        return f.what;
    };
    CHECK(refused(strokes(4, 0.1)) == "max_strokes");
    CHECK(refused(strokes(3, 201.0)) == "max_stroke_s");
    CHECK(plan_request(p, layout(p.tactors), strokes(1, 600.0)).plans.size() == 1);
}

TEST_CASE("planning ends between strokes when asked to")
{
    const planning p = palm();
    const json two{{"toml", "[[stroke]]\npath = 'M 0 0 L 40 40'\n[[stroke]]\npath = 'M 0 0 L 40 0'\n"}};
    int asked = 0;
    const auto f = fault_from([&] {
        plan_request(p, layout(p.tactors), two, [&] {
            if (++asked == 2)
                refuse_without_stream("the server ends");
        });
    });
    CHECK(f.code == net::code_no_stream);
    CHECK(asked == 2);
}

TEST_CASE("the ceiling holds for level, intensity and dB SL")
{
    planning p = palm();
    for (tactor_spec& t : p.tactors.tactors)
        t.threshold_dbfs = -40.0;
    const layout faces(p.tactors);
    const auto plays = [&](const json& params) {
        try {
            plan_request(p, faces, params);
            return true;
        } catch (const fault_error&) {
            return false;
        }
    };
    const auto path = [](const json& options) {
        return json{{"path", "M 0 0 L 40 40"}, {"options", options}};
    };
    CHECK(plays(path({{"level_dbfs", -12}})));
    CHECK_FALSE(plays(path({{"level_dbfs", -11.99}})));
    CHECK(plays(path({{"sl", 28}})));
    CHECK_FALSE(plays(path({{"sl", 28.01}})));
    // The threshold at the stroke's own carrier counts.
    planning measured = p;
    for (tactor_spec& t : measured.tactors.tactors)
        t.thresholds = {{50.0, -10.0}, {250.0, -40.0}};
    CHECK(plan_request(measured, faces, path({{"sl", 20}, {"carrier", 250}})).plans.size() == 1);
    CHECK(fault_from([&] {
              plan_request(measured, faces, path({{"sl", 20}, {"carrier", 50}}));
          }).what == "options.sl");
    const auto points = [](double intensity, double level) {
        return json{{"points", {{0, 0, 0}, {0.5, 20, 20, intensity}, {1, 40, 40}}},
                    {"options", {{"algorithm", "continuous"}, {"level_dbfs", level}}}};
    };
    CHECK(plays(points(1.0, -12)));
    CHECK_FALSE(plays(points(1.1, -12)));
    // JSON has null for nan: the touch is lifted. A recorder's times and scale are its own.
    CHECK(plays({{"points", {{7, 0, 0, 51}, {7, 5, 5, 255}, {7.5, nullptr, 20, 9}, {8, 40, 40, 0}}},
                 {"options", {{"intensity_max", 255}}}}));
    CHECK(fault_from([&] { plan_request(p, faces, points(255, -60)); }).what == "points");
    const auto of_file = [](const char* algorithm, double own_db, double level_dbfs, const char* scale) {
        return json{
            {"toml",
             fmt::format("[stroke]\npath = 'M 0 0 L 40 40'\nintensity = 0.5\nlevel_db = {}\n", own_db)},
            {"options", {{"algorithm", algorithm}, {"level_dbfs", level_dbfs}, {"intensity_scale", scale}}}};
    };
    for (const char* algorithm : {"park2016", "continuous"}) {
        CHECK(plays(of_file(algorithm, -3.0, -2.98, "linear"))); // half is -6.021 dB
        CHECK_FALSE(plays(of_file(algorithm, -3.0, -2.97, "linear")));
        CHECK(plays(of_file(algorithm, -1.0, -0.97, "stevens"))); // half is -10.034 dB
        CHECK_FALSE(plays(of_file(algorithm, -1.0, -0.96, "stevens")));
    }
    CHECK(fault_from([&] { plan_request(p, faces, of_file("park2016", 0.5, -40.0, "linear")); }).what ==
          "toml");
    // Half of the amplitude is 6 dB less than -6 dBFS, half of 34 dB SL is 17 dB less.
    const auto half = [](const char* scale) {
        return json{{"points", {{0, 0, 0, 0.5}, {1, 40, 40, 0.5}}},
                    {"options", {{"algorithm", "continuous"}, {"sl", 34}, {"intensity_scale", scale}}}};
    };
    CHECK(plays(half("linear")));
    CHECK(plays(half("sl")));
    p.max_level_dbfs = -20.0;
    CHECK_FALSE(plays(half("linear"))); // -12 dBFS
    CHECK_FALSE(plays(half("stevens")));
    CHECK(plays(half("sl"))); // -23 dBFS
}

TEST_CASE("strokes that meet are weakened, not refused, where only their meeting exceeds level or ceiling")
{
    planning with = palm();
    for (tactor_spec& t : with.tactors.tactors)
        t.max_dbfs = -12.0; // as the server limits all channels to the ceiling
    const layout faces(with.tactors);
    const auto peak_db = [&](const planned& p) { // of the middle tactor, all strokes together
        std::vector<double> sum;
        for (std::size_t i = 0; i < p.plans.size(); ++i) {
            const score s = p.make_score(with.tactors, i);
            std::vector<float> x(s.frames() * s.channels());
            renderer(s, format_kind::float32).process(std::as_writable_bytes(std::span(x)));
            sum.resize(std::max<std::size_t>(sum.size(), s.frames()));
            for (std::size_t k = 0; k < s.frames(); ++k)
                sum[k] += static_cast<double>(x[k * s.channels() + 4]);
        }
        double most = 0.0;
        for (const double v : sum)
            most = std::max(most, std::abs(v));
        return 20.0 * std::log10(most);
    };
    const auto make = [&](double level_dbfs, double intensity, const char* together) {
        std::string toml;
        for (const char* path : {"M 0 20 H 40", "M 40 20 H 0", "M 20 0 V 40"})
            toml += fmt::format("[[stroke]]\npath = '{}'\nduration_s = 1.4\nstart_s = 0.0\nintensity = {}\n",
                                path, intensity);
        const json params{{"toml", toml}, {"options", {{"level_dbfs", level_dbfs}, {"together", together}}}};
        return plan_request(with, faces, params, resolve_options(with.owner, params));
    };
    for (const double level : {-40.0, -12.0}) {
        const planned p = make(level, 1.0, "weaken");
        CHECK(p.weakened.weakened_db == doctest::Approx(-9.542).epsilon(1e-4));
        CHECK(p.weakened.tactor == 4);
        CHECK(p.weakened.plans == std::vector<std::size_t>{0, 1, 2});
        CHECK(peak_db(p) == doctest::Approx(level).epsilon(1e-4));
    }
    // Each is within the ceiling by its intensity: -6 dBFS of 0.5.
    const planned loud = make(-6.0, 0.5, "weaken");
    CHECK(loud.weakened.weakened_db == doctest::Approx(-9.522).epsilon(1e-4)); // three times -12.02 dBFS
    CHECK(peak_db(loud) == doctest::Approx(-12.0).epsilon(1e-4));
    CHECK(peak_db(make(-40.0, 1.0, "sum")) == doctest::Approx(-30.458).epsilon(1e-4));
    CHECK(fault_from([&] { make(-12.0, 1.0, "sum"); }).what == "options.level_dbfs");
}

} // namespace request_test
