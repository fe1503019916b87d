// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "own_curve.hpp"
#include "pieces.hpp"

namespace levels_test {

using namespace tactor;
using namespace pieces;

namespace {

const plan one = make_plan({make_burst(0.0, 0.07, {{0, 0.6}, {1, 0.8}})});

double peak(const score& s, unsigned c)
{
    double p = 0.0;
    for (const double x : channel(s, c))
        p = std::max(p, std::abs(x));
    return p;
}

std::string message(const std::function<void()>& f)
{
    try {
        f();
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
    return "no error";
}

bool holds(const std::string& text, const std::string& part)
{
    if (text.find(part) == std::string::npos) {
        MESSAGE(text);
        return false;
    }
    return true;
}

} // namespace

TEST_CASE("the level is -12 dBFS by default, and gain_db is added to it")
{
    array a = row(2);
    a.tactors[1].gain_db = -6.0;
    const score s(a, {{one, {}}}, {});
    CHECK(peak(s, 0) == doctest::Approx(0.6 * std::pow(10.0, -0.6)));
    CHECK(peak(s, 1) == doctest::Approx(0.8 * std::pow(10.0, -0.9)));
    a.tactors[1].gain_db = 6.0;
    CHECK(peak(score(a, {{one, {}}}, {}), 1) == doctest::Approx(0.8 * std::pow(10.0, -0.3)));
}

TEST_CASE("a sensation level is above each tactor's threshold, without gain_db")
{
    array a = row(2);
    a.tactors[0].threshold_dbfs = -40.0;
    a.tactors[1].threshold_dbfs = -30.0;
    a.tactors[1].gain_db = 3.0;
    render_options o;
    o.sl_db = 7.0;
    const score s(a, {{one, {}}}, o);
    CHECK(peak(s, 0) == doctest::Approx(0.6 * std::pow(10.0, -33.0 / 20.0)));
    CHECK(peak(s, 1) == doctest::Approx(0.8 * std::pow(10.0, -23.0 / 20.0)));
    a.tactors[1].threshold_dbfs.reset();
    a.tactors[1].where = {"palm.toml", 7, 1};
    CHECK(holds(message([&] { score(a, {{one, {}}}, o); }), "palm.toml:7:1: tactor 1 has no threshold_dbfs"));
    CHECK(caught_field([&] { score(a, {{one, {}}}, o); }).empty()); // threshold_dbfs and sl_db together
    a.tactors[1].threshold_dbfs = -3.0;
    CHECK(holds(message([&] { score(a, {{one, {}}}, o); }), "full scale"));
}

TEST_CASE("polarity inverts a channel")
{
    array a = row(2);
    a.tactors[1].polarity = -1;
    const score s(a, {{make_plan({make_burst(0.0, 0.07, {{0, 0.5}, {1, 0.5}})}), {}}}, {});
    const auto x = channel(s, 0);
    const auto y = channel(s, 1);
    CHECK(peak(s, 0) > 0.1);
    for (std::size_t k = 0; k < x.size(); ++k)
        REQUIRE(x[k] == -y[k]);
}

TEST_CASE("impossible levels are refused")
{
    render_options o;
    for (const double level : {0.1, 1e9, std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        o.level_dbfs = level;
        CHECK(holds(message([&] { score(row(2), {{one, {}}}, o); }), "level_dbfs"));
    }
    array a = row(2);
    a.tactors[1].gain_db = 12.5;
    a.tactors[1].where = {"palm.toml", 7, 1};
    const std::string text = message([&] { score(a, {{one, {}}}, {}); });
    CHECK(caught_field([&] { score(a, {{one, {}}}, {}); }).empty()); // gain_db and level_dbfs together
    CHECK(holds(text, "palm.toml:7:1"));
    CHECK(holds(text, "0.5 dBFS"));
    a.tactors[1].gain_db = 12.0;
    CHECK(message([&] { score(a, {{one, {}}}, {}); }) == "no error");
}

TEST_CASE("an impossible length is refused by its name")
{
    plan p = one;
    p.total_s = -1.0;
    CHECK(caught_field([&] { score(row(2), p); }) == "total_s");
    p = one;
    p.stroke_duration_s = 1e9;
    CHECK(caught_field([&] { score(row(2), p); }) == "stroke_duration_s");
}

TEST_CASE("a tactor's limit is compared with the score's level for it")
{
    array a = row(2);
    a.tactors[1].max_dbfs = -14.0;
    a.tactors[1].where = {"palm.toml", 9, 1};
    // 0.8 at -12 dBFS is -13.94 dBFS.
    const std::string text = message([&] { score(a, {{one, {}}}, {}); });
    CHECK(holds(text, "palm.toml:9:1: tactor 1 would be driven at -13.94 dBFS"));
    CHECK(holds(text, "limit of -14 dBFS"));
    CHECK(holds(text, "by 0.07 dB or more"));
    a.tactors[1].max_dbfs = -13.93;
    CHECK(message([&] { score(a, {{one, {}}}, {}); }) == "no error");
    a.tactors[0].max_dbfs = -13.0;
    CHECK(message([&] { score(a, {{one, {}}, {one, {}}}, {}); }) == "no error");
    CHECK(holds(message([&] { score(a, {{one, {}}, {one, 0.03}}, {}); }), "tactor 0"));
}

TEST_CASE("a sensation level that is too high names the threshold and the excess")
{
    array a = row(2);
    a.tactors[0].threshold_dbfs = -30.0;
    a.tactors[1].threshold_dbfs = -6.0;
    a.tactors[1].where = {"me.toml", 9, 1};
    render_options o;
    o.sl_db = 9.0; // 0.8 of it: 7.06 dB above -6 dBFS
    const std::string text = message([&] { score(a, {{one, {}}}, o); });
    CHECK(holds(text, "me.toml:9:1: tactor 1 would be driven at 1.062 dBFS, above full scale (0 dBFS): with "
                      "its threshold of -6 dBFS 1.07 dB are missing"));
    CHECK(holds(text, "lower sl_db by 1.07 dB or more"));
    a.tactors[1].max_dbfs = -3.0;
    CHECK(holds(message([&] {
                    score(a, {{one, {}}}, o);
                }),
                "above its limit of -3 dBFS (max_dbfs): with its threshold of -6 dBFS 4.07 dB are missing"));
}

TEST_CASE("a sensation level that is too high names the threshold at the stroke's carrier")
{
    array a = row(2);
    a.tactors[0].thresholds = {{60.0, -9.6}, {100.0, -1.6}, {250.0, -40.0}};
    a.tactors[1].threshold_dbfs = -50.0;
    render_options o;
    o.sl_db = 7.0;
    plan slow = make_plan({make_burst(0.0, 0.07, {{0, 1.0}, {1, 1.0}})});
    slow.carrier_hz = 100.0;
    CHECK(holds(message([&] {
                    score(a, {{one, {}}, {slow, {}}}, o);
                }),
                "driven at 5.4 dBFS, above full scale (0 dBFS): with its threshold of -1.6 dBFS 5.40 dB"));
}

TEST_CASE("only tactors that are driven need a threshold")
{
    array a = row(3);
    a.tactors[1].threshold_dbfs = -40.0;
    a.tactors[0].max_dbfs = -20.0;
    render_options o;
    o.sl_db = 7.0;
    const plan middle = make_plan({make_burst(0.0, 0.07, {{1, 1.0}})});
    const score s(a, {{middle, {}}}, o);
    CHECK(peak(s, 1) == doctest::Approx(std::pow(10.0, -33.0 / 20.0)));
    CHECK(peak(s, 0) == 0.0);
    CHECK(holds(message([&] { score(a, {{middle, {}}, {one, {}}}, o); }), "tactor 0: has no threshold_dbfs"));
    // A continuous stroke drives the tactors on its way.
    plan_options smooth;
    smooth.algorithm = algorithm_kind::continuous;
    smooth.outside = outside_kind::clamp;
    a.tactors[2].threshold_dbfs = -40.0;
    const auto along = [&](double x_mm) {
        return make_plan(
            a,
            stroke{"k", trajectory::along(path::polyline(std::vector<point>{{20.0, 0.0}, {x_mm, 0.0}}), 0.5)},
            smooth);
    };
    CHECK(message([&] { score(a, {{along(40.0), {}}}, o); }) == "no error");
    CHECK(holds(message([&] { score(a, {{along(10.0), {}}}, o); }), "tactor 0: has no threshold_dbfs"));
}

TEST_CASE("strokes that add up beyond full scale are refused, one at full scale is not")
{
    const plan full = make_plan({make_burst(0.0, 0.07, {{0, 1.0}}), make_burst(0.07, 0.07, {{0, 1.0}})});
    render_options o;
    o.level_dbfs = 0.0;
    for (const unsigned rate : {8000U, 22050U, 44100U, 48000U}) {
        o.rate = rate;
        CHECK(message([&] { score(row(1), {{full, {}}, {full, {}}}, o); }) == "no error");
        CHECK(holds(message([&] {
                        score(row(1), {{full, {}}, {full, 0.1}}, o);
                    }),
                    "6.021 dBFS, above full scale"));
    }
    const plan loud = make_plan({make_burst(0.0, 0.07, {{0, 1.5}}, 1.5)});
    CHECK(holds(message([&] { score(row(1), {{loud, {}}}, o); }), "3.522 dBFS"));
}

TEST_CASE("a burst of one frame counts, and so does one frame in which two sound")
{
    array a = row(1);
    a.tactors[0].max_dbfs = -12.0;
    render_options o;
    o.rate = 8000;
    o.ramp_s = 0.0;
    const double frame_s = 1.0 / o.rate;
    const auto one_at = [](double onset_s, double duration_s) {
        return make_plan({make_burst(onset_s, duration_s, {{0, 1.0}})});
    };
    CHECK(message([&] { score(a, {{one_at(0.0, frame_s), 0.0}}, o); }) == "no error");
    CHECK(holds(message([&] {
                    score(a, {{make_plan({make_burst(0.0, frame_s, {{0, 1000.0}}, 1000.0)}), 0.0}}, o);
                }),
                "tactor 0: would be driven at 48 dBFS"));
    CHECK(message([&] {
              score(a, {{one_at(0.0, 4 * frame_s), 0.0}, {one_at(0.0, frame_s), 4 * frame_s}}, o);
          }) == "no error");
    // The first sample of a stroke is 0: rounding may put it into the end of the one before.
    CHECK(message([&] {
              score(a, {{one_at(0.0, 4 * frame_s), 0.0}, {one_at(0.0, 2 * frame_s), 3 * frame_s}}, o);
          }) == "no error");
    for (const double start_s : {frame_s, 2 * frame_s, 3 * frame_s}) {
        CAPTURE(start_s);
        CHECK(holds(message([&] {
                        score(a, {{one_at(0.0, 4 * frame_s), 0.0}, {one_at(0.0, frame_s), start_s}}, o);
                    }),
                    "tactor 0: would be driven at -5.979 dBFS"));
        CHECK(
            holds(message([&] {
                      score(a, {{make_continuous(1, 4 * frame_s), 0.0}, {one_at(0.0, frame_s), start_s}}, o);
                  }),
                  "tactor 0: would be driven at -5.979 dBFS"));
    }
    // A ramp begins with a frame of zero: an overlap of one frame by rounding is not heard together.
    o.ramp_s = 0.001;
    const double burst_s = 200 * frame_s;
    CHECK(message([&] {
              score(a, {{one_at(0.0, burst_s), 0.0}, {one_at(0.0, burst_s), burst_s - frame_s}}, o);
          }) == "no error");
    CHECK(holds(message([&] {
                    score(a, {{one_at(0.0, burst_s), 0.0}, {one_at(0.0, burst_s), burst_s - 2 * frame_s}}, o);
                }),
                "tactor 0"));
}

TEST_CASE("overlaps in one plan count by their rule")
{
    plan p = make_plan({make_burst(0.0, 0.1, {{0, 0.8}}), make_burst(0.05, 0.1, {{0, 0.8}})});
    render_options o;
    o.level_dbfs = 0.0;
    CHECK(message([&] { score(row(1), {{p, {}}}, o); }) == "no error");
    p.overlap = overlap_kind::sum;
    CHECK(holds(message([&] { score(row(1), {{p, {}}}, o); }), "4.082 dBFS"));
    p.overlap = overlap_kind::max;
    CHECK(message([&] { score(row(1), {{p, {}}}, o); }) == "no error");
}

TEST_CASE("continuous strokes are held to the limits too")
{
    array a = row(3);
    a.tactors[1].max_dbfs = -12.1;
    CHECK(holds(message([&] { score(a, {{make_continuous(3, 0.5), {}}}, {}); }), "tactor 1"));
    a.tactors[1].max_dbfs = -12.0;
    CHECK(message([&] { score(a, {{make_continuous(3, 0.5), {}}}, {}); }) == "no error");
    plan bad = make_continuous(3, 0.5);
    bad.curve = tactor::test::make_curve(0.5, [](double, burst& out) {
        out.drives.assign(1, {0, std::nan("")});
    });
    CHECK(holds(message([&] { score(a, {{bad, {}}}, {}); }), "nan"));
    bad.curve = tactor::test::make_curve(0.5, [](double, burst& out) { out.drives.assign(1, {3, 0.5}); });
    CHECK(holds(message([&] { score(a, {{bad, {}}}, {}); }), "tactor 3"));
}

TEST_CASE("an excess in the last digits is accepted")
{
    const auto sum = [](double amplitude) {
        std::vector<placed_plan> all;
        for (const double a : {0.13, 0.16, 0.17, 0.2, amplitude})
            all.push_back({make_plan({make_burst(0.0, 0.1, {{0, a}})}), 0.0, {}});
        render_options o;
        o.level_dbfs = 0.0;
        return message([&] { score(row(1), all, o); });
    };
    REQUIRE(0.13 + 0.16 + 0.17 + 0.2 + 0.34 > 1.0);
    CHECK(sum(0.34) == "no error");
    CHECK(holds(sum(0.34 + 1e-8), "would be driven at"));
}

TEST_CASE("a carrier that passes a threshold on its way is held to the limit there")
{
    array a = row(1);
    a.tactors[0].thresholds = {{100.0, -40.0}, {200.0, -20.0}, {400.0, -40.0}};
    plan p = make_continuous(1, 1.0);
    p.curve = tactor::test::make_curve(1.0, [](double, burst& out) { out.drives = {{0, 1.0}}; });
    p.course = {{0.0, 100.0}, {1.0, 400.0}};
    render_options o;
    o.sl_db = 19.0;
    CHECK(message([&] { score(a, {{p, {}}}, o); }) == "no error");
    o.sl_db = 25.0;
    CHECK(holds(message([&] { score(a, {{p, {}}}, o); }), "tactor 0: would be driven at 5 dBFS"));
    p.course = {{0.0, 400.0}, {1.0, 250.0}};
    CHECK(message([&] { score(a, {{p, {}}}, o); }) == "no error");
}

TEST_CASE("impossible render options are refused")
{
    const auto with = [](auto change) {
        return message([&] {
            render_options o;
            plan p = one;
            std::optional<double> start;
            change(o, p, start);
            score(row(2), {{p, start}}, o);
        });
    };
    CHECK(holds(with([](auto& o, auto&, auto&) { o.rate = 7999; }), "7999"));
    CHECK(holds(with([](auto& o, auto&, auto&) { o.rate = 768001; }), "768001"));
    CHECK(holds(with([](auto& o, auto&, auto&) { o.channels = 1; }), "too few"));
    CHECK(holds(with([](auto& o, auto&, auto&) { o.channels = 16385; }), "16385"));
    CHECK(holds(with([](auto& o, auto&, auto&) { o.ramp_s = -0.001; }), "ramp_s"));
    CHECK(holds(with([](auto& o, auto&, auto&) { o.ramp_s = std::nan(""); }), "ramp_s"));
    for (const double hz : {24000.0, 1e9, 0.0, -250.0, std::nan("")})
        CHECK(holds(with([hz](auto&, auto& p, auto&) { p.carrier_hz = hz; }), "48000 Hz"));
    CHECK(with([](auto&, auto& p, auto&) { p.carrier_hz = 23999.0; }) == "no error");
    for (const double s : {-0.1, 1e300, std::nan("")}) {
        CHECK(holds(with([s](auto&, auto&, auto& start) { start = s; }), "start"));
        CHECK(holds(with([s](auto&, auto& p, auto&) { p.total_s = s; }), "lasts"));
        CHECK(holds(with([s](auto&, auto& p, auto&) { p.bursts[0].onset_s = s; }), "burst 1"));
        CHECK(holds(with([s](auto&, auto& p, auto&) { p.bursts[0].duration_s = s; }), "burst 1"));
    }
    CHECK(holds(with([](auto&, auto& p, auto&) { p.bursts[0].drives[1].amplitude = std::nan(""); }), "nan"));
    CHECK(holds(with([](auto&, auto& p, auto&) { p.bursts[0].drives[1].tactor = 2; }), "tactor 2"));
}

} // namespace levels_test
