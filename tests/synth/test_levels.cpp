// SPDX-License-Identifier: MIT
// Levels, and strokes that overlap.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "has.hpp"
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

// Returns the message of the error for a score whose strokes add up, or "".
std::string refusal(const array& a, const std::vector<placed_plan>& plans, render_options o = {})
{
    o.together = together_kind::sum;
    return caught_message([&] { score(a, plans, o); });
}

/// Makes two bursts of 0.1 s, overlapping from 0.06 s to 0.1 s, on tactor 0.
plan two_bursts(overlap_kind join, double a, double b, double a_v = 1.0)
{
    plan p = make_plan({make_burst(0.0, 0.1, {{0, a}}, a_v), make_burst(0.06, 0.1, {{0, b}}, a_v)});
    p.overlap = join;
    return p;
}

score make_score(const plan& p, double ramp_s)
{
    render_options o{.ramp_s = ramp_s, .level_dbfs = 0.0};
    o.phase = phase_kind::burst; // test_oscillator.cpp has the tests of the stroke's phase
    return {row(2), {{p, {}}}, o};
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
    render_options o{.sl_db = 7.0};
    const score s(a, {{one, {}}}, o);
    CHECK(peak(s, 0) == doctest::Approx(0.6 * std::pow(10.0, -33.0 / 20.0)));
    CHECK(peak(s, 1) == doctest::Approx(0.8 * std::pow(10.0, -23.0 / 20.0)));
    a.tactors[1].threshold_dbfs.reset();
    a.tactors[1].where = {"palm.toml", 7, 1};
    has(refusal(a, {{one, {}}}, o), "palm.toml:7:1: tactor 1 has no threshold_dbfs");
    CHECK(caught_field([&] { score(a, {{one, {}}}, o); }).empty()); // threshold_dbfs and sl_db together
    a.tactors[1].threshold_dbfs = -3.0;
    has(refusal(a, {{one, {}}}, o), "full scale");
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
        has(refusal(row(2), {{one, {}}}, o), "level_dbfs");
    }
    array a = row(2);
    a.tactors[1].gain_db = 12.5;
    a.tactors[1].where = {"palm.toml", 7, 1};
    const std::string text = refusal(a, {{one, {}}}, {});
    CHECK(caught_field([&] { score(a, {{one, {}}}, {}); }).empty()); // gain_db and level_dbfs together
    has(text, "palm.toml:7:1");
    has(text, "0.5 dBFS");
    a.tactors[1].gain_db = 12.0;
    CHECK(refusal(a, {{one, {}}}, {}).empty());
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
    const std::string text = refusal(a, {{one, {}}}, {});
    has(text, "palm.toml:9:1: tactor 1 would play at -13.94 dBFS");
    has(text, "max_dbfs of -14 dBFS");
    has(text, "by 0.07 dB or more");
    a.tactors[1].max_dbfs = -13.93;
    CHECK(refusal(a, {{one, {}}}, {}).empty());
    a.tactors[0].max_dbfs = -13.0;
    CHECK(refusal(a, {{one, {}}, {one, {}}}, {}).empty());
    // Both are too loud: the reduction that is enough for both is the cure.
    const std::string both = refusal(a, {{one, {}}, {one, 0.03}}, {});
    has(both, "tactor 1 would play at -7.918 dBFS");
    has(both, "by 6.02 dB or more");
}

TEST_CASE("a sensation level that is too high names the threshold at the stroke's carrier")
{
    array a = row(2);
    a.tactors[0].thresholds = {{60.0, -9.6}, {100.0, -1.6}, {250.0, -40.0}};
    a.tactors[1].threshold_dbfs = -50.0;
    plan slow = make_plan({make_burst(0.0, 0.07, {{0, 1.0}, {1, 1.0}})});
    slow.carrier_hz = 100.0;
    has(refusal(a, {{one, {}}, {slow, {}}}, {.sl_db = 7.0}),
        "would play at 5.4 dBFS, above full scale, because its threshold is -1.6 dBFS (lower sl_db by 5.40 "
        "dB");
}

TEST_CASE("only tactors that are driven need a threshold")
{
    array a = row(3);
    a.tactors[1].threshold_dbfs = -40.0;
    a.tactors[0].max_dbfs = -20.0;
    render_options o{.sl_db = 7.0};
    const plan middle = make_plan({make_burst(0.0, 0.07, {{1, 1.0}})});
    const score s(a, {{middle, {}}}, o);
    CHECK(peak(s, 1) == doctest::Approx(std::pow(10.0, -33.0 / 20.0)));
    CHECK(peak(s, 0) == 0.0);
    has(refusal(a, {{middle, {}}, {one, {}}}, o), "tactor 0: it has no threshold_dbfs");
    // A continuous stroke drives the tactors on its way.
    a.tactors[2].threshold_dbfs = -40.0;
    const auto along = [&](double x_mm) {
        return make_plan(
            a,
            stroke{"k", trajectory::along(path::polyline(std::vector<point>{{20.0, 0.0}, {x_mm, 0.0}}), 0.5)},
            {.algorithm = algorithm_kind::continuous, .outside = outside_kind::clamp});
    };
    CHECK(refusal(a, {{along(40.0), {}}}, o).empty());
    has(refusal(a, {{along(10.0), {}}}, o), "tactor 0: it has no threshold_dbfs");
}

TEST_CASE("strokes that add up beyond full scale are refused, one at full scale is not")
{
    const plan full = make_plan({make_burst(0.0, 0.07, {{0, 1.0}}), make_burst(0.07, 0.07, {{0, 1.0}})});
    render_options o{.level_dbfs = 0.0};
    for (const unsigned rate : {8000U, 22050U, 44100U, 48000U}) {
        o.rate = rate;
        CHECK(refusal(row(1), {{full, {}}, {full, {}}}, o).empty());
        has(refusal(row(1), {{full, {}}, {full, 0.1}}, o), "6.021 dBFS, above full scale");
    }
    const plan loud = make_plan({make_burst(0.0, 0.07, {{0, 1.5}}, 1.5)});
    has(refusal(row(1), {{loud, {}}}, o), "3.522 dBFS");
}

TEST_CASE("a burst of one frame counts, and so does one frame in which two sound")
{
    array a = row(1);
    a.tactors[0].max_dbfs = -12.0;
    render_options o{.rate = 8000, .ramp_s = 0.0};
    const double frame_s = 1.0 / o.rate;
    const auto one_at = [](double onset_s, double duration_s) {
        return make_plan({make_burst(onset_s, duration_s, {{0, 1.0}})});
    };
    CHECK(refusal(a, {{one_at(0.0, frame_s), 0.0}}, o).empty());
    has(refusal(a, {{make_plan({make_burst(0.0, frame_s, {{0, 1000.0}}, 1000.0)}), 0.0}}, o),
        "tactor 0: it would play at 48 dBFS");
    CHECK(refusal(a, {{one_at(0.0, 4 * frame_s), 0.0}, {one_at(0.0, frame_s), 4 * frame_s}}, o).empty());
    // The first sample of a stroke is 0: rounding may put it into the end of the one before.
    CHECK(refusal(a, {{one_at(0.0, 4 * frame_s), 0.0}, {one_at(0.0, 2 * frame_s), 3 * frame_s}}, o).empty());
    for (const double start_s : {frame_s, 2 * frame_s, 3 * frame_s}) {
        CAPTURE(start_s);
        has(refusal(a, {{one_at(0.0, 4 * frame_s), 0.0}, {one_at(0.0, frame_s), start_s}}, o),
            "tactor 0: it would play at -5.979 dBFS");
        has(refusal(a, {{make_continuous(1, 4 * frame_s), 0.0}, {one_at(0.0, frame_s), start_s}}, o),
            "tactor 0: it would play at -5.979 dBFS");
    }
    // A ramp begins with a frame of zero: an overlap of one frame by rounding is not heard together.
    o.ramp_s = 0.001;
    const double burst_s = 200 * frame_s;
    CHECK(refusal(a, {{one_at(0.0, burst_s), 0.0}, {one_at(0.0, burst_s), burst_s - frame_s}}, o).empty());
    has(refusal(a, {{one_at(0.0, burst_s), 0.0}, {one_at(0.0, burst_s), burst_s - 2 * frame_s}}, o),
        "tactor 0");
}

TEST_CASE("overlaps in one plan count by their rule")
{
    plan p = make_plan({make_burst(0.0, 0.1, {{0, 0.8}}), make_burst(0.05, 0.1, {{0, 0.8}})});
    render_options o{.level_dbfs = 0.0};
    CHECK(refusal(row(1), {{p, {}}}, o).empty());
    p.overlap = overlap_kind::sum;
    has(refusal(row(1), {{p, {}}}, o), "4.082 dBFS");
    p.overlap = overlap_kind::max;
    CHECK(refusal(row(1), {{p, {}}}, o).empty());
}

TEST_CASE("continuous strokes are held to the limits too")
{
    array a = row(3);
    a.tactors[1].max_dbfs = -12.1;
    has(refusal(a, {{make_continuous(3, 0.5), {}}}, {}), "tactor 1");
    a.tactors[1].max_dbfs = -12.0;
    CHECK(refusal(a, {{make_continuous(3, 0.5), {}}}, {}).empty());
    plan bad = make_continuous(3, 0.5);
    bad.curve = tactor::test::make_curve(0.5, [](double, burst& out) {
        out.drives.assign(1, {0, std::nan("")});
    });
    has(refusal(a, {{bad, {}}}, {}), "nan");
    bad.curve = tactor::test::make_curve(0.5, [](double, burst& out) { out.drives.assign(1, {3, 0.5}); });
    has(refusal(a, {{bad, {}}}, {}), "tactor 3");
}

TEST_CASE("an excess in the last digits is accepted")
{
    const auto sum = [](double amplitude) {
        std::vector<placed_plan> all;
        for (const double a : {0.13, 0.16, 0.17, 0.2, amplitude})
            all.push_back({make_plan({make_burst(0.0, 0.1, {{0, a}})}), 0.0, {}});
        return refusal(row(1), all, {.level_dbfs = 0.0});
    };
    REQUIRE(0.13 + 0.16 + 0.17 + 0.2 + 0.34 > 1.0);
    CHECK(sum(0.34).empty());
    has(sum(0.34 + 1e-8), "would play at");
}

TEST_CASE("a carrier that passes a threshold on its way is held to the limit there")
{
    array a = row(1);
    a.tactors[0].thresholds = {{100.0, -40.0}, {200.0, -20.0}, {400.0, -40.0}};
    plan p = make_continuous(1, 1.0);
    p.curve = tactor::test::make_curve(1.0, [](double, burst& out) { out.drives = {{0, 1.0}}; });
    p.course = {{0.0, 100.0}, {1.0, 400.0}};
    render_options o{.sl_db = 19.0};
    CHECK(refusal(a, {{p, {}}}, o).empty());
    o.sl_db = 25.0;
    has(refusal(a, {{p, {}}}, o), "tactor 0: it would play at 5 dBFS");
    p.course = {{0.0, 400.0}, {1.0, 250.0}};
    CHECK(refusal(a, {{p, {}}}, o).empty());
}

TEST_CASE("impossible render options are refused")
{
    const auto with = [](auto change) {
        render_options o;
        plan p = one;
        std::optional<double> start;
        change(o, p, start);
        return refusal(row(2), {{p, start}}, o);
    };
    CHECK(has(with([](auto& o, auto&, auto&) { o.rate = 7999; }), "7999"));
    CHECK(has(with([](auto& o, auto&, auto&) { o.rate = 768001; }), "768001"));
    CHECK(has(with([](auto& o, auto&, auto&) { o.channels = 1; }), "too few"));
    CHECK(has(with([](auto& o, auto&, auto&) { o.channels = 16385; }), "16385"));
    CHECK(has(with([](auto& o, auto&, auto&) { o.ramp_s = -0.001; }), "ramp_s"));
    CHECK(has(with([](auto& o, auto&, auto&) { o.ramp_s = std::nan(""); }), "ramp_s"));
    for (const double hz : {24000.0, 1e9, 0.0, -250.0, std::nan("")})
        CHECK(has(with([hz](auto&, auto& p, auto&) { p.carrier_hz = hz; }), "48000 Hz"));
    CHECK(with([](auto&, auto& p, auto&) { p.carrier_hz = 23999.0; }).empty());
    for (const double s : {-0.1, 1e300, std::nan("")}) {
        CHECK(has(with([s](auto&, auto&, auto& start) { start = s; }), "start"));
        CHECK(has(with([s](auto&, auto& p, auto&) { p.total_s = s; }), "lasts"));
        CHECK(has(with([s](auto&, auto& p, auto&) { p.bursts[0].onset_s = s; }), "burst 1"));
        CHECK(has(with([s](auto&, auto& p, auto&) { p.bursts[0].duration_s = s; }), "burst 1"));
    }
    CHECK(has(with([](auto&, auto& p, auto&) { p.bursts[0].drives[1].amplitude = std::nan(""); }), "nan"));
    CHECK(has(with([](auto&, auto& p, auto&) { p.bursts[0].drives[1].tactor = 2; }), "tactor 2"));
}

TEST_CASE("the largest intensity is that of any sounding burst, not only of the last")
{
    for (const bool louder_first : {true, false}) {
        CAPTURE(louder_first);
        plan p =
            make_plan({make_burst(0.0, 0.1, {{0, louder_first ? 0.9 : 0.5}}, louder_first ? 0.95 : 0.5),
                       make_burst(0.0, 0.1, {{0, louder_first ? 0.5 : 0.9}}, louder_first ? 0.5 : 0.95)});
        const auto x = channel(make_score(p, 0.0), 0);
        CHECK(x[48] == doctest::Approx(0.95)); // sqrt(0.81 + 0.25) would be more
        // An amplitude that a scale raised above the intensity may stay so.
        p.bursts[0].intensity = p.bursts[1].intensity = 0.3;
        CHECK(channel(make_score(p, 0.0), 0)[48] == doctest::Approx(0.9));
    }
}

TEST_CASE("a joined burst falls as smoothly as alone, however slowly it has risen")
{
    plan both = make_plan({make_burst(0.0, 0.1, {{0, 0.6}}), make_burst(0.06, 0.14, {{0, 0.6}})});
    both.overlap = overlap_kind::max;
    const plan alone = make_plan({make_burst(0.0, 0.2, {{0, 0.6}})});
    for (const auto& [attack_s, release_s] : {std::pair{0.05, 0.002}, {0.0, 0.002}, {0.002, 0.03}}) {
        CAPTURE(attack_s);
        render_options o{.level_dbfs = 0.0};
        o.envelope = {.kind = envelope_kind::raised_cosine, .attack_s = attack_s, .release_s = release_s};
        const auto x = channel(score(row(1), both, o), 0);
        const auto y = channel(score(row(1), alone, o), 0);
        REQUIRE(x.size() == y.size());
        const auto last = static_cast<std::size_t>(48000 * release_s);
        const double near = last > 128 ? 0.6 * 0.002 : 1e-6; // long ones are drawn by 64 lines
        for (std::size_t k = x.size() - last; k < x.size(); ++k)
            REQUIRE(std::abs(x[k] - y[k]) < near);
    }
}

TEST_CASE("ramps of overlapping bursts go into the joined amplitude, at the default length exactly")
{
    for (const std::int64_t ramp : {0, 96, 480}) {
        const double a = 0.5;
        const double b = 0.4;
        for (const overlap_kind join : {overlap_kind::energy, overlap_kind::max, overlap_kind::sum}) {
            const score s = make_score(two_bursts(join, a, b), static_cast<double>(ramp) / 48000.0);
            const auto x = channel(s, 0);
            for (std::int64_t k = 0; k < 7680; ++k) {
                const double wa = k < 4800 ? a * window(k, 4800, ramp) : 0.0;
                const double wb = k >= 2880 ? b * window(k - 2880, 4800, ramp) : 0.0;
                double e = std::min(1.0, std::sqrt(wa * wa + wb * wb));
                e = join == overlap_kind::max ? std::max(wa, wb) : (join == overlap_kind::sum ? wa + wb : e);
                REQUIRE(std::abs(x[static_cast<std::size_t>(k)] - e * sine(250.0, k)) <
                        (ramp <= 96 ? 1e-6 : 2e-3));
            }
        }
    }
}

TEST_CASE("only the tactor with the overlap is joined")
{
    const plan p =
        make_plan({make_burst(0.01, 0.1, {{0, 0.6}, {1, 0.3}}), make_burst(0.06, 0.1, {{0, 0.5}})});
    const auto joined = channel(make_score(p, 0.0), 0);
    const auto single = channel(make_score(p, 0.0), 1);
    CHECK(joined[480 + 48] == doctest::Approx(0.6));
    CHECK(single[480 + 48] == doctest::Approx(0.3));
    CHECK(single[480 + 4800] == 0.0);
}

TEST_CASE("a long chain of overlaps is one carrier")
{
    std::vector<burst> bursts;
    for (int i = 0; i < 50; ++i)
        bursts.push_back(make_burst(0.04 * i, 0.1, {{0, 0.3}}));
    const score s = make_score(make_plan(bursts, 251.0), 0.0);
    const auto x = channel(s, 0);
    for (std::size_t k = 4800; k + 9600 < x.size(); ++k) {
        const std::size_t place = k % 1920;
        const double a = 0.3 * std::sqrt(place < 960 ? 3.0 : 2.0);
        REQUIRE(std::abs(x[k] - a * sine(251.0, k)) < 1e-6);
    }
}

TEST_CASE("several plans in one score add, each with its own carrier")
{
    const plan a = make_plan({make_burst(0.0, 0.1, {{0, 0.3}})}, 250.0);
    const plan b = make_plan({make_burst(0.0, 0.1, {{0, 0.3}})}, 200.0);
    const auto x = channel(score(row(1), {{a, 0.0}, {b, 0.0}}, {.level_dbfs = 0.0}), 0);
    for (std::size_t k = 0; k < x.size(); ++k)
        REQUIRE(std::abs(x[k] - 0.3 * (sine(250.0, k) + sine(200.0, k))) < 1e-6);
}

} // namespace levels_test
