// SPDX-License-Identifier: MIT
// Continuous plans as values, with samples kept or computed when read.
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/plan.hpp>

#include "caught.hpp"

namespace curve_test {

using namespace tactor;

namespace {

const array palm = preset_array("palm-3x3");

plan_options continuous()
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    return o;
}

plan flowing(double duration_s)
{
    stroke s = preset_stroke("park2016-3");
    s.motion = s.motion.with_duration(duration_s);
    return make_plan(palm, s, continuous());
}

curve_samples read_samples(const curve& c)
{
    curve_samples all;
    burst b;
    for (std::uint64_t k = 0; k < c.size(); ++k) {
        c.sample(k, b);
        all.add(b);
    }
    return all;
}

struct counting final : phantom_model {
    mutable std::uint64_t asked = 0;
    std::string_view name() const noexcept override { return "mine"; }
    void weights(point, double a_v, std::vector<drive>& out) const override
    {
        ++asked;
        out = {{4, 0.5 * a_v}};
    }
};

} // namespace

TEST_CASE("a curve has a sample each millisecond and one at its end")
{
    for (const auto& [duration, samples] :
         {std::pair{1.4, 1401U}, {0.0004, 2U}, {1.4002, 1402U}, {7.0, 7001U}}) {
        CAPTURE(duration);
        const plan p = flowing(duration);
        REQUIRE(p.curve);
        CHECK(p.curve->size() == samples);
        CHECK(p.curve->duration_s() == duration);
        burst b;
        p.curve->sample(samples - 1, b);
        CHECK(b.onset_s == doctest::Approx(duration).epsilon(1e-12));
        burst beyond;
        p.curve->sample(samples + 7, beyond);
        CHECK(beyond == b);
    }
}

TEST_CASE("a sample replaces the whole of a burst")
{
    for (const double duration : {1.4, 7.0}) { // kept, and computed
        const plan p = flowing(duration);
        burst fresh;
        p.curve->sample(700, fresh);
        burst used = make_plan(palm, preset_stroke("park2016-1")).bursts[3];
        used.tau_s = 0.1;
        p.curve->sample(700, used);
        CHECK(used == fresh);
        CHECK(used.duration_s == 0.0);
        CHECK_FALSE(used.tau_s);
        used.duration_s = 0.07;
        used.tau_s = 0.1;
        p.curve->at(0.7, used);
        CHECK(used == fresh);
        used.duration_s = 0.07;
        used.tau_s = 0.1;
        p.curve->at(0.70025, used);
        CHECK(used.duration_s == 0.0);
        CHECK_FALSE(used.tau_s);
    }
}

TEST_CASE("a plan made again from its samples is the same plan, short or long")
{
    for (const double duration : {0.01, 1.4, 3.9995, 5.0, 12.3456}) {
        CAPTURE(duration);
        const plan p = flowing(duration);
        plan again = p;
        again.curve = curve(duration, read_samples(*p.curve));
        CHECK(again == p);
        CHECK(p == flowing(duration));
        CHECK(p != flowing(duration + 0.001));

        curve_samples other = read_samples(*p.curve);
        other.drives.back().amplitude = std::nextafter(other.drives.back().amplitude, 2.0);
        again.curve = curve(duration, other);
        CHECK(again != p);
        again.curve.reset();
        CHECK(again != p);
    }
    const plan bursts = make_plan(palm, preset_stroke("park2016-3"));
    CHECK(bursts == make_plan(palm, preset_stroke("park2016-3")));
    CHECK(bursts != make_plan(palm, preset_stroke("park2016-4")));
}

TEST_CASE("a curve is linear between samples, as it sounds")
{
    curve_samples s;
    burst b;
    b.position = {0.0, 10.0};
    b.drives = {{0, 0.5}, {3, 0.25}};
    s.add(b);
    b.position = {4.0, 10.0};
    b.intensity = 3.0;
    b.drives = {{3, 0.75}, {8, 1.0}};
    s.add(b);
    const curve c(0.001, s);
    c.at(0.00025, b);
    CHECK(b.onset_s == 0.00025);
    CHECK(b.position == point{1.0, 10.0});
    CHECK(b.intensity == 1.5);
    CHECK(b.drives == std::vector<drive>{{0, 0.375}, {3, 0.375}, {8, 0.25}});
    c.at(1e-10, b); // a nanosecond changes nothing
    CHECK(b.drives.size() == 2);
    c.at(5.0, b);
    CHECK(b.drives == std::vector<drive>{{3, 0.75}, {8, 1.0}});
    c.at(std::numeric_limits<double>::quiet_NaN(), b);
    CHECK(b.position == point{0.0, 10.0});
}

TEST_CASE("a custom model is asked when the stroke is planned, once for each sample")
{
    const auto mine = std::make_shared<counting>();
    plan_options o = continuous();
    o.custom_phantom = mine;
    stroke s = preset_stroke("park2016-1");
    const plan p = make_plan(palm, s, o);
    CHECK(mine->asked == 1401);
    burst b;
    p.curve->at(0.7, b);
    CHECK(b.drives == std::vector<drive>{{4, 0.5}});
    CHECK(p.phantom == "mine");
    CHECK(mine->asked == 1401);
    s.motion = s.motion.with_duration(20000.0);
    CHECK(caught_message([&] {
              static_cast<void>(make_plan(palm, s, o));
          }).find("2e+07 samples of phantom model \"mine\"") != std::string::npos);
    CHECK(mine->asked == 1401);
}

TEST_CASE("impossible samples of a curve are refused")
{
    const curve_samples good = read_samples(*flowing(0.01).curve);
    const auto refused = [](double duration_s, const curve_samples& s) {
        return caught_message([&] { curve(duration_s, s); });
    };
    CHECK(refused(0.01, good).empty());
    for (const double duration : {0.0, -1.0, HUGE_VAL, std::nan(""), 86401.0})
        CHECK(refused(duration, good).find("curve: it lasts") == 0);
    CHECK(caught_field([&] { curve(0.0, good); }) == "duration_s");
    CHECK(refused(0.011, good).find("0.011 s has 12 samples") != std::string::npos);
    const auto with = [&](auto change) {
        curve_samples s = good;
        change(s);
        return refused(0.01, s);
    };
    CHECK(with([](curve_samples& s) { s.positions[3].x_mm = std::nan(""); }).find("sample 3") !=
          std::string::npos);
    CHECK(with([](curve_samples& s) { s.intensities[4] = HUGE_VAL; }).find("sample 4") != std::string::npos);
    CHECK(with([](curve_samples& s) { s.drives[0].amplitude = std::nan(""); }).find("sample 0") !=
          std::string::npos);
    CHECK(with([](curve_samples& s) { s.ends[2] = 0; }).find("sample 2") != std::string::npos);
    CHECK(with([](curve_samples& s) { s.ends.back() += 1; }).find("sample 10") != std::string::npos);
    CHECK(with([](curve_samples& s) { s.ends.pop_back(); }).find("10 ends") != std::string::npos);
    CHECK(with([](curve_samples& s) { std::swap(s.drives[0], s.drives[1]); }).find("after tactor") !=
          std::string::npos);
}

} // namespace curve_test
