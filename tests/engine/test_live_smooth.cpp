// SPDX-License-Identifier: MIT
// Points that come in groups, smoothed over a window.
#include <cmath>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "rig.hpp"

namespace live_smooth_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr std::uint64_t window = 2400; // 0.05 s

// Drives the first tactor by the place: x = 40 is 1.
class across final : public phantom_model {
public:
    std::string_view name() const noexcept override { return "across"; }
    void weights(point p, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        if (p.x_mm > 0.0)
            out.push_back({0, a_v * p.x_mm / 40.0});
        if (p.y_mm > 39.0)
            throw error(error_kind::bad_input, "across", "not there");
    }
};

live_options smoothed(double seconds = 0.05)
{
    live_options o;
    o.plan.custom_phantom = std::make_shared<across>();
    o.smooth_s = seconds;
    return o;
}

// A stroke at one place and, some frames later, at x = 40.
struct moved_rig : live_rig {
    moved_rig(const live_options& o, double from_mm, std::uint64_t frames, double intensity = 1.0)
        : live_rig(o)
    {
        live->to({from_mm, 0.0}, 1.0);
        base = status().written;
        play(frames);
        came = status().written - base;
        live->to({40.0, 0.0}, intensity);
    }
    std::uint64_t base = 0; ///< frame of the first point
    std::uint64_t came = 0; ///< that of the second, from there on
};

// Returns x at each crest of the carrier from a frame on, mm: crests are 96 frames apart.
std::vector<double> places(const live_rig& r, std::uint64_t base, std::uint64_t from)
{
    constexpr std::uint64_t crest = 48;
    std::vector<double> x;
    const auto s = r.channel(0, base);
    for (std::uint64_t i = from + crest; i < s.size(); i += 96)
        x.push_back(40.0 * std::abs(s[i]) / live_level);
    return x;
}

bool near(double a, double b)
{
    return std::abs(a - b) < 1e-3;
}

// Gives too much at its first call, and refuses the second.
struct odd_model final : phantom_model {
    void weights(point, double a_v, std::vector<drive>& out) const override
    {
        ++asked;
        if (asked == 2)
            throw error(error_kind::bad_input, "point", "not here", "go on");
        out.push_back({4, asked == 1 ? 2.0 * a_v : a_v});
    }
    std::string_view name() const noexcept override { return "odd"; }
    mutable int asked = 0;
};

} // namespace

TEST_CASE(
    "without smoothing a point holds from the next period on; with it the place moves evenly over the window")
{
    for (const double seconds : {0.0, 0.05}) {
        CAPTURE(seconds);
        moved_rig r(smoothed(seconds), 10.0, 4800);
        r.play(9600);
        CHECK(near(places(r, r.base, 96).front(), 10.0)); // the first one at once
        const auto x = places(r, r.base, r.came);
        for (std::size_t k = 0; k < 90; ++k) {
            CAPTURE(k);
            const double gone = 48.0 + 96.0 * static_cast<double>(k);
            const double takes = seconds == 0.0 ? 96.0 : static_cast<double>(window);
            REQUIRE(near(x[k], 10.0 + 30.0 * std::min(gone / takes, 1.0)));
        }
    }
}

TEST_CASE("groups of points as long as the window: even speed, half a window and half a group behind")
{
    live_rig r(smoothed());
    r.live->to({0.0, 0.0}, 1.0);
    const std::uint64_t base = r.status().written;
    double x_mm = 0.0;
    for (std::uint64_t n = 0; n < 20; ++n) {
        for (int i = 0; i < 5; ++i) // 2 mm a burst
            r.live->to({x_mm += 0.4, 0.0}, 1.0);
        for (std::uint64_t f = 0; f < window; f += 96)
            r.play(96);
    }
    const auto x = places(r, base, 0);
    REQUIRE(x.size() >= 500);
    // The points are of the 0.05 s before they come: at frame f the finger was at 2 + 2 f / window.
    for (std::size_t k = 25; k < 500; ++k)
        REQUIRE(near(x[k], 2.0 * (48.0 + 96.0 * static_cast<double>(k)) / static_cast<double>(window)));
}

TEST_CASE("intensity moves with the place, in bursts of the carrier too")
{
    live_options o = smoothed(0.2);
    o.plan.algorithm = algorithm_kind::park2016;
    moved_rig r(o, 40.0, 2400, 0.5);
    r.play(14'400);
    const auto s = r.channel(0, r.base);
    for (std::uint64_t at = 0; at + 3360 <= 16'800; at += 3360) {
        CAPTURE(at);
        const double gone = at < r.came ? 0.0 : static_cast<double>(at - r.came) / 9600.0;
        CHECK(peak(s, at + 480, at + 960) ==
              doctest::Approx(live_level * (1.0 - 0.5 * std::min(gone, 1.0))).epsilon(1e-3));
    }
}

TEST_CASE(
    "end waits until the last point is reached; a cancel does not, nor the end of a touch that stands still")
{
    using engine::live_voice;
    for (const auto how : {live_voice::action::end, live_voice::action::cancel}) {
        moved_rig r(smoothed(), 10.0, 960);
        const bool ended = how == live_voice::action::end;
        const auto report = r.finish(how);
        CHECK(report.state == (ended ? state_kind::finished : state_kind::cancelled));
        CHECK(report.frames == r.came + (ended ? window : 0) + 480);
    }
    live_rig still(smoothed());
    still.live->to({10.0, 0.0}, 1.0);
    const std::uint64_t base = still.status().written;
    still.play(960);
    const std::uint64_t came = still.status().written - base;
    CHECK(still.finish().frames == came + 480);
}

TEST_CASE("a refused point leaves the place as it was, even on the way")
{
    moved_rig r(smoothed(), 10.0, 960);
    r.play(960);
    CHECK_THROWS_AS(r.live->to({0.0, 40.0}, 1.0), error);
    CHECK_THROWS_WITH_AS(r.live->to({0.0, 0.0}, -0.5), doctest::Contains("-0.5"), error);
    CHECK(r.live->points == 2);
    r.play(4800);
    const auto x = places(r, r.base, r.came);
    for (std::size_t k = 0; k < 50; ++k)
        REQUIRE(near(x[k], 10.0 + 30.0 * std::min((48.0 + 96.0 * static_cast<double>(k)) / window, 1.0)));
}

TEST_CASE("an excess at a refused point does not fail the next one")
{
    live_options o = smoothed();
    const auto model = std::make_shared<odd_model>();
    model->asked = 100;
    o.plan.custom_phantom = model;
    live_rig r(o);
    REQUIRE(r.live->to({10.0, 0.0}, 0.5));
    r.play(960);
    model->asked = 0;
    CHECK_THROWS_AS(r.live->to({20.0, 0.0}, 0.5), error);
    CHECK(r.live->to({20.0, 0.0}, 0.5));
}

TEST_CASE("the smoothed place is the mean over the window, however the points came")
{
    std::mt19937_64 random(3);
    for (const std::uint64_t w : {1U, 7U, 100U}) {
        engine::smoothing s(w);
        std::vector<double> told; // place by frame
        double x = 0.0;
        for (std::uint64_t frame = 0; frame < 1000; ++frame) {
            if (frame == 0 || random() % 11 == 0) {
                x = static_cast<double>(1 + random() % 1000);
                s.to(frame, {{x, -x}, x});
                s.to(frame, {{x, -x}, x}); // a repeated point counts once
            }
            told.push_back(x);
            double sum = 0.0;
            for (std::uint64_t back = 0; back < w; ++back)
                sum += told[frame - std::min(back, frame)];
            // A point of a frame holds after it.
            const auto p = s.at(frame + 1);
            REQUIRE(p.at.x_mm == doctest::Approx(sum / static_cast<double>(w)));
            REQUIRE(p.at.y_mm == -p.at.x_mm);
            REQUIRE(p.intensity == doctest::Approx(p.at.x_mm));
        }
        s.to(2000, {{5.0, 0.0}, 1.0});
        CHECK(s.frames_to_target() == w);
        CHECK(s.at(2000 + w).at.x_mm == 5.0);
    }
}

TEST_CASE("after a pause the touch is at its new place, not on its way from the old one")
{
    engine::smoothing s(100);
    s.to(0, {{10.0, 0.0}, 1.0});
    s.to(200, {{10.0, 0.0}, 0.0}); // lifted
    CHECK(s.at(250).at.x_mm == 10.0);
    CHECK(s.at(250).intensity == doctest::Approx(0.5));
    CHECK(s.at(300).at.x_mm == 10.0);
    CHECK(s.at(300).intensity == 0.0);
    s.to(400, {{30.0, 0.0}, 1.0});
    CHECK(s.at(450).at.x_mm == 30.0);
    CHECK(s.at(450).intensity == doctest::Approx(0.5));
}

} // namespace live_smooth_test
