// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <tuple>

#include <doctest/doctest.h>

#include <fmt/format.h>

#include "core/kind_names.hpp"
#include "files/plan/plan_json.hpp"
#include "percept/compare.hpp"
#include "server/view.hpp"
#include "service_rig.hpp"

namespace view_test {

using namespace tactor;
using namespace tactor::server;
using net::json;

namespace {

constexpr std::size_t tactors = 9;
constexpr double time_off = 0.51e-5; // half of what numbers are rounded to, and of the last bit
constexpr double mm_off = 0.51e-3;
constexpr double amplitude_off = 0.51e-4;

const char* const three_strokes = R"([[stroke]]
path = "M 0 0 L 40 40"
duration_s = 1
[[stroke]]
path = "M 0 20 L 40 20"
start_s = 0.5
duration_s = 0.7
algorithm = "continuous"
[[stroke]]
path = "M 0 0 L 40 0"
duration_s = 0.8
algorithm = "tactile-brush"
)";

planning palm()
{
    planning p;
    p.tactors = preset_array("palm-3x3");
    return p;
}

planned make(const json& params)
{
    const planning p = palm();
    return plan_request(p, layout(p.tactors), params, resolve_options(p.owner, params));
}

json look(const planned& p, const view_choice& v)
{
    return json::parse(view_text(p, palm().tactors, v, std::size_t{1} << 24U));
}

json look(const planned& p, view_kind k)
{
    return look(p, view_choice{k});
}

json line(double duration_s, const char* algorithm, json more = json::object())
{
    more["path"] = "M 0 0 L 40 40";
    more["options"]["duration"] = duration_s;
    more["options"]["algorithm"] = algorithm;
    return more;
}

bool near(const json& a, double b, double off)
{
    return std::abs(a.get<double>() - b) <= off;
}

double amplitude(const burst& b, std::size_t tactor)
{
    for (const drive& d : b.drives)
        if (d.tactor == tactor)
            return d.amplitude;
    return 0.0;
}

// Checks a row of a view against a burst.
void check_row(const json& v, std::size_t i, const burst& b, double onset_s, double duration_s)
{
    CHECK(near(v["onsets"][i], onset_s, time_off));
    CHECK(near(v["durations"][i], duration_s, time_off));
    CHECK(near(v["positions"][2 * i], b.position.x_mm, mm_off));
    CHECK(near(v["positions"][2 * i + 1], b.position.y_mm, mm_off));
    CHECK(near(v["intensities"][i], b.intensity, amplitude_off));
    for (std::size_t k = 0; k < tactors; ++k)
        CHECK(near(v["amplitudes"][tactors * i + k], amplitude(b, k), amplitude_off));
}

// Checks all rows of a view against the plans; returns their number.
std::size_t check_rows(const json& v, const planned& p)
{
    std::size_t i = 0;
    for (std::size_t k = 0; k < p.plans.size(); ++k) {
        const plan& one = p.plans[k].plan;
        const double start_s = p.starts_s()[k];
        const json& s = v["strokes"][k];
        CHECK(s["name"] == p.strokes[k].name);
        CHECK(near(s["start_s"], start_s, time_off));
        CHECK(near(s["total_s"], one.total_s, time_off));
        CHECK(near(s["duration_s"], one.stroke_duration_s, time_off));
        CHECK(s["first"] == i);
        CHECK(s["algorithm"] == one.algorithm);
        CHECK(s["continuous"] == one.curve.has_value());
        const auto count = s["count"].get<std::size_t>();
        CHECK((one.curve || count == one.bursts.size()));
        burst b;
        for (std::size_t row = 0; row < count; ++row, ++i) {
            const double step_s = one.stroke_duration_s / static_cast<double>(count);
            if (one.curve) {
                one.curve->at(static_cast<double>(row) * step_s, b);
                check_row(v, i, b, start_s + static_cast<double>(row) * step_s, step_s);
            } else {
                b = one.bursts[row];
                check_row(v, i, b, start_s + b.onset_s, b.duration_s);
            }
        }
    }
    CHECK(v["onsets"].size() == i);
    CHECK(v["positions"].size() == 2 * i);
    CHECK(v["amplitudes"].size() == tactors * i);
    CHECK(v["tactors"] == tactors);
    CHECK(near(v["total_s"], p.total_s(), time_off));
    return i;
}

// The row of `tactor compare` for the stroke of a request.
json compared(const planned& p, std::size_t i, const planning& with)
{
    detail::comparison_choice c;
    c.algorithms = {*detail::find_kind<algorithm_kind>(p.plans[i].plan.algorithm)};
    c.phantoms = {phantom_kind::inverse_distance};
    c.observer = p.observer;
    const detail::comparison all =
        detail::compare(p.strokes[i], with.tactors, layout(with.tactors), with.owner.plan, c);
    return json::parse(files::comparisons_text({all}, with.tactors))["results"][0];
}

// Checks a prediction against the row of `tactor compare`.
void check_errors(const json& errors, const json& row)
{
    CHECK(errors.size() == 17);
    for (const auto& [name, value] : errors.items())
        CHECK_MESSAGE(row[name] == value, name);
}

// Largest amplitude of a tactor at a time; at an end of a burst it is on.
double loudest_at(const planned& p, std::size_t tactor, double t_s, double before_s, double after_s)
{
    double most = 0.0;
    burst at;
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const plan& one = p.plans[i].plan;
        const double t = t_s - p.starts_s()[i];
        for (const burst& b : one.bursts)
            if (b.onset_s < t + after_s && b.onset_s + b.duration_s > t - before_s)
                most = std::max(most, amplitude(b, tactor));
        if (one.curve && t >= 0.0 && t <= one.stroke_duration_s) {
            one.curve->at(t, at);
            most = std::max(most, amplitude(at, tactor));
        }
    }
    return most;
}

} // namespace

TEST_CASE("a view answers where play would refuse for the level, and says by how much")
{
    const json both{{"toml", "[[stroke]]\npath = 'M 0 0 H 40'\nduration_s = 1.0\nstart_s = 0.0\n"
                             "[[stroke]]\npath = 'M 0 0 H 40'\nduration_s = 1.0\nstart_s = 0.0\n"},
                    {"options", {{"level_dbfs", -1.0}, {"together", "sum"}}}};
    tactor::test::running_rig rig([](service_options& o, stream_options&) { o.plans.max_level_dbfs = -1.0; });
    const auto c = rig.client();
    CHECK(rig.code(c, "plan", both) == -32602);
    json picture = both;
    picture["view"] = "peaks";
    const json told = rig.ok(c, "plan", picture)["warnings"].back();
    CHECK(told["kind"] == "level");
    // Two strokes are 6.02 dB stronger than one of -1 dBFS.
    CHECK(told["over_db"].get<double>() == doctest::Approx(5.02).epsilon(0.01));
    picture["options"]["level_dbfs"] = -6.1;
    CHECK(rig.ok(c, "plan", picture)["warnings"].empty());
    // Weakened, they may be played.
    picture["options"] = {{"level_dbfs", -1.0}};
    const json weakened = rig.ok(c, "plan", picture);
    CHECK(weakened["warnings"].empty());
    CHECK(weakened["weakened_db"].get<double>() == doctest::Approx(-6.02).epsilon(0.001));
    CHECK(weakened["meets"]["strokes"] == json{0, 1});
    json played = both;
    played.erase("options");
    const json answer = rig.ok(c, "play", played);
    CHECK(answer["weakened_db"].get<double>() == doctest::Approx(-6.02).epsilon(0.001));
    CHECK(answer["meets"]["tactor"] == weakened["meets"]["tactor"]);
    played["toml"] = "[stroke]\npath = 'M 0 0 H 40'\nduration_s = 0.1\n";
    const json alone = rig.ok(c, "play", played);
    CHECK(alone["weakened_db"] == 0.0);
    CHECK_FALSE(alone.contains("meets"));
    // The owner's ceiling counts, too.
    picture["options"]["level_dbfs"] = 0.0;
    picture["toml"] = "[stroke]\npath = 'M 0 0 H 40'\nduration_s = 1.0\n";
    CHECK(rig.ok(c, "plan", picture)["warnings"].back()["over_db"] == 1.0);
}

TEST_CASE("the excess of a view is what brings the strongest tactor to its limit")
{
    tactor::test::running_rig rig([](service_options& o, stream_options&) {
        o.plans.max_level_dbfs = 0.0;
        o.plans.tactors.tactors[0].max_dbfs = -12.0;
        o.plans.tactors.tactors[1].gain_db = 2.0; // full scale at -2 dBFS
    });
    const auto c = rig.client();
    const std::string one = "[[stroke]]\npath = 'M 0 0 H 40'\nduration_s = 1.0\nstart_s = 0.0\n";
    for (const auto& [toml, together, expected_db] :
         {std::tuple(one, "sum", 12.0),
          {one + one, "sum", 12.0 + 20.0 * std::log10(2.0)},
          {one + one, "weaken", 12.0 - 20.0 * std::log10(2.0) /* of each alone */}}) {
        json params{{"toml", toml}, {"options", {{"level_dbfs", 0.0}, {"together", together}}}};
        const auto plays_at = [&](double level_dbfs) {
            params["options"]["level_dbfs"] = level_dbfs;
            return rig.code(c, "plan", params) == 0;
        };
        json picture = params;
        picture["view"] = "peaks";
        const double over_db = rig.ok(c, "plan", picture)["warnings"].back()["over_db"];
        CHECK(std::abs(over_db - expected_db) <= 0.0051);
        CHECK(plays_at(-over_db - 0.0051));
        CHECK_FALSE(plays_at(-over_db + 0.0051));
    }
}

TEST_CASE("bursts: each burst of each stroke, by the clock of all together")
{
    for (const char* algorithm : {"park2016", "tactile-brush"}) {
        const planned p = make(line(2.0, algorithm));
        const json v = look(p, view_kind::bursts);
        CHECK(check_rows(v, p) == p.plans[0].plan.bursts.size());
        CHECK(v["continuous"] == false);
        CHECK_FALSE(v.contains("felt"));
    }
    const planned moved = make(line(2.0, "park2016", {{"options", {{"compensate", "low-speed"}}}}));
    check_rows(look(moved, view_kind::bursts), moved);
    const planned p = make({{"toml", three_strokes}});
    const json v = look(p, view_kind::bursts);
    check_rows(v, p);
    CHECK(v["continuous"] == true);
    CHECK(v["strokes"].size() == 3);
    CHECK(v["strokes"][1]["count"] == 350);
    CHECK(v["warnings"].size() == p.warnings().size());
}

TEST_CASE("a curve has at most 2,000 rows, one in 2 ms, and one at least")
{
    for (const auto& [duration_s, rows] : {std::pair(0.001, 1), {0.06, 30}, {2.0, 1000}, {600.0, 2000}}) {
        const planned p = make(line(duration_s, "continuous"));
        CHECK(check_rows(look(p, view_kind::bursts), p) == static_cast<std::size_t>(rows));
    }
    std::string toml;
    for (int i = 0; i < 64; ++i)
        toml += fmt::format("[[stroke]]\npath = 'M 0 0 L 40 40'\nalgorithm = 'continuous'\nduration_s = {}\n",
                            i % 8 == 0 ? 60.0 : 0.001);
    const planned p = make({{"toml", toml}});
    const json bursts = look(p, view_kind::bursts);
    const std::size_t rows = check_rows(bursts, p);
    CHECK(rows <= 2000);
    CHECK(rows > 1800);
    for (const json& s : bursts["strokes"])
        CHECK(s["count"] > 0);
    CHECK(look(p, view_kind::percept)["felt"].size() <= 2000);
}

TEST_CASE("percept: the numbers of tactor compare, and the places felt")
{
    planning with = palm();
    const layout faces(with.tactors);
    for (const char* observer : {"centroid", "low-speed"})
        for (const char* algorithm : {"park2016", "tactile-brush", "continuous"}) {
            json params = line(2.0, algorithm, {{"view", "percept"}, {"observer", observer}});
            const planned p = plan_request(with, faces, params, resolve_options(with.owner, params));
            const json v = look(p, view_kind::percept);
            check_rows(v, p);
            CHECK(v["observer"] == observer);
            CHECK(v["errors"] == v["strokes"][0]["errors"]);
            check_errors(v["errors"], compared(p, 0, with));
            CHECK(v["strokes"][0]["felt_first"] == 0);
            CHECK(v["strokes"][0]["felt_count"] == v["felt"].size());
            CHECK(v["felt"].empty() == (observer[0] == 'l' && algorithm[0] == 'c'));
        }
    // The owner's observer, and the client's parameters of it.
    with.owner.observer = observer_kind::low_speed;
    const json params = line(1.0, "park2016", {{"view", "percept"}, {"options", {{"sigma_mm", 9}}}});
    const planned p = plan_request(with, faces, params, resolve_options(with.owner, params));
    CHECK(p.observer.kind == observer_kind::low_speed);
    CHECK(p.observer.low_speed.sigma_mm == 9.0);
    const json other = line(1.0, "park2016");
    CHECK(plan_request(with, faces, other, resolve_options(with.owner, other)).observer.kind ==
          observer_kind::centroid);
}

TEST_CASE("percept: places felt at their times, thinned out evenly, held in silence")
{
    const planning with = palm();
    const array& a = with.tactors;
    for (const double duration_s : {0.06, 2.0, 30.0}) {
        const planned p = make(line(duration_s, "park2016", {{"view", "percept"}}));
        const json felt = look(p, view_kind::percept)["felt"];
        const auto samples = predict_percept(a, p.strokes[0], p.plans[0].plan);
        CHECK(felt.size() <= 2000);
        CHECK(felt.size() >= std::min<std::size_t>(samples.size() / 2, 1800));
        point last;
        auto row = felt.begin();
        for (const percept_sample& x : samples) {
            last = x.felt.value_or(last);
            if (row == felt.end() || !near((*row)[0], x.t_s, time_off))
                continue;
            CHECK(near((*row)[1], last.x_mm, mm_off));
            CHECK(near((*row)[2], last.y_mm, mm_off));
            CHECK(near((*row)[3], x.intensity, amplitude_off));
            ++row;
        }
        CHECK(row == felt.end());
    }
    // Taps; silent bursts have none.
    const planned p = make({{"points", {{0, 0, 0, 1}, {1, 20, 20, 0}, {2, 20, 20, 0}, {3, 40, 40, 0.5}}},
                            {"view", "percept"},
                            {"observer", "low-speed"}});
    const plan& one = p.plans[0].plan;
    const json felt = look(p, view_kind::percept)["felt"];
    const auto taps = predict_taps(a, p.strokes[0], one);
    REQUIRE(felt.size() == taps.size());
    CHECK(taps.size() < one.bursts.size());
    for (std::size_t i = 0; i < taps.size(); ++i) {
        const auto b = std::find_if(one.bursts.begin(), one.bursts.end(),
                                    [&](const burst& x) { return x.onset_s == taps[i].onset_s; });
        CHECK(near(felt[i][0], taps[i].onset_s, time_off));
        CHECK(near(felt[i][1], taps[i].felt.x_mm, mm_off));
        CHECK(near(felt[i][2], taps[i].felt.y_mm, mm_off));
        CHECK(near(felt[i][3], b->intensity, amplitude_off));
    }
}

TEST_CASE("percept of several strokes: errors of each, and on top those of the worst")
{
    const planning with = palm();
    const planned p = make({{"toml", three_strokes}, {"view", "percept"}});
    const json v = look(p, view_kind::percept);
    double worst = 0.0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const json& s = v["strokes"][i];
        check_errors(s["errors"], compared(p, i, with));
        worst = std::max(worst, s["errors"]["rms_to_path_mm"].get<double>());
        CHECK(s["felt_first"] == first);
        const auto count = s["felt_count"].get<std::size_t>();
        REQUIRE(count > 0);
        CHECK(near(v["felt"][first][0], p.starts_s()[i], time_off));
        first += count;
    }
    CHECK(v["felt"].size() == first);
    CHECK(v["errors"]["rms_to_path_mm"] == worst);
}

TEST_CASE("peaks: the largest amplitude of each tactor in each part of the time")
{
    for (const json& params : {line(0.06, "park2016"), line(2.0, "tactile-brush"), line(0.06, "continuous"),
                               line(3.0, "continuous"), json{{"toml", three_strokes}}}) {
        const planned p = make(params);
        const std::size_t bins = 50;
        const json v = look(p, {view_kind::peaks, bins});
        const double step_s = v["step_s"];
        CHECK(step_s == doctest::Approx(p.total_s() / bins));
        REQUIRE(v["peaks"].size() == bins * tactors);
        CHECK_FALSE(v.contains("onsets"));
        for (std::size_t i = 0; i < bins; ++i)
            for (std::size_t k = 0; k < tactors; ++k) {
                // A dense look at the bin: what is on at its middle, or anywhere within for bursts.
                double most = 0.0;
                const int looks = 200;
                for (int look = 0; look <= looks; ++look) {
                    const double part = static_cast<double>(look) / looks;
                    const double t_s = (static_cast<double>(i) + part) * step_s;
                    most = std::max(
                        most, loudest_at(p, k, t_s, part * step_s - 1e-9, (1.0 - part) * step_s - 1e-9));
                }
                CHECK(near(v["peaks"][i * tactors + k], most, 2e-3));
            }
    }
    const planned p = make(line(600.0, "continuous"));
    const json v = look(p, {view_kind::peaks, 4000});
    CHECK(v["peaks"].size() == 4000 * tactors);
    CHECK(near(v["peaks"][4 + tactors * 2000], 1.0, 0.01)); // the middle of the diagonal
}

TEST_CASE("a view that is too long is not made")
{
    const planned p = make(line(2.0, "continuous"));
    for (const view_kind k : {view_kind::bursts, view_kind::percept, view_kind::peaks})
        CHECK_THROWS_AS(static_cast<void>(view_text(p, palm().tactors, {k, 4000}, 10'000)), std::bad_alloc);
}

} // namespace view_test
