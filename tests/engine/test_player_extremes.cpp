// SPDX-License-Identifier: MIT
// Impossible numbers: errors, or a sensible meaning.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace player_extremes_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array absurd{nan, infinity, -infinity, 1e308, -1e308, -1.0};
constexpr std::int64_t earliest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t latest = std::numeric_limits<std::int64_t>::max();

template <typename T>
concept takes_as_frame = requires(T t)
{
    start_at::frame(t);
};
template <typename T>
concept takes_as_time = requires(T t)
{
    start_at::time(t);
};
template <typename T>
concept fires = requires(player& p, T t)
{
    p.fire(t);
};
template <typename T>
concept submits = requires(player& p, const score& s, T t)
{
    p.submit(s, t);
};
template <typename T>
concept cancels = requires(player& p, T t)
{
    p.cancel(t);
};
template <typename... T>
concept moves = requires(live_stroke& l, T... t)
{
    l.to(1.0, 2.0, t...);
};
template <typename T>
concept waits = requires(player& p, T t)
{
    p.wait(stroke_id{1}, t);
};

static_assert(cancels<stroke_id> && !cancels<int> && !cancels<unsigned>);
static_assert(!std::is_default_constructible_v<start_at>);
static_assert(submits<start_at> && !submits<int> && !submits<std::uint64_t> && !submits<double>);
static_assert(!std::is_constructible_v<start_at, int> && !std::is_constructible_v<start_at, double>);
static_assert(takes_as_frame<int> && !takes_as_frame<double> && !takes_as_frame<bool>);
static_assert(takes_as_time<std::int64_t> && !takes_as_time<double>);
static_assert(moves<double> && moves<int> && !moves<std::int64_t>);
static_assert(moves<double, std::int64_t> && !moves<double, double>);
static_assert(waits<double> && waits<int> && !waits<std::int64_t>);
static_assert(fires<std::int64_t> && !fires<double>);
static_assert(start_at::frame(7).stream_frame() == 7 && start_at::frame(8U).stream_frame() == 8);

// Reports true where a call succeeds or throws error.
bool no_harm(const std::function<void()>& call)
{
    try {
        call();
        return true;
    } catch (const error&) {
        return true;
    } catch (...) {
        return false;
    }
}

class scripted_input final : public edge_input {
public:
    explicit scripted_input(std::vector<std::int64_t> times) : times_(std::move(times)) { REQUIRE(fd_ >= 0); }
    ~scripted_input() override { ::close(fd_); }
    int descriptor() const noexcept override { return fd_; }
    std::optional<gpio_edge> read() noexcept override
    {
        std::uint64_t n = 0;
        if (::read(fd_, &n, sizeof n) < 0 || next_ == times_.size())
            return std::nullopt;
        return gpio_edge{times_[next_++], true};
    }
    void edge() const
    {
        const std::uint64_t one = 1;
        REQUIRE(::write(fd_, &one, sizeof one) == sizeof one);
    }

private:
    int fd_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    std::vector<std::int64_t> times_;
    std::size_t next_ = 0;
};

} // namespace

TEST_CASE("a negative frame is an error with a hint")
{
    try {
        static_cast<void>(start_at::frame(-1));
        FAIL("no error");
    } catch (const error& e) {
        has(e.what(), "start: frame -1 (frames of the stream count from 0");
    }
    CHECK_THROWS_AS(start_at::frame(earliest), error);
}

TEST_CASE("a time before all times plays now and reports how late; one after all times waits")
{
    rig r;
    r.play(48'000);
    REQUIRE(r.link.clock.load().valid());
    const stroke_id early = r.submit(tone(0.01), start_at::time(earliest));
    const stroke_id fired = r.submit(tone(0.01), start_at::trigger());
    CHECK(r.feed.fire(earliest) == 1);
    r.play_out();
    for (const stroke_id id : {early, fired}) {
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).late_s > 9e9);
    }
    const stroke_id late = r.submit(tone(0.01), start_at::time(latest));
    const stroke_id far = r.submit(tone(0.01), start_at::frame(std::numeric_limits<std::uint64_t>::max()));
    r.play(48'000);
    CHECK_FALSE(r.report(late));
    CHECK_FALSE(r.report(far));
    CHECK(r.feed.cancel(late));
    CHECK(r.feed.cancel(far));
    r.control();
    CHECK(r.end(late).state == state_kind::cancelled);
    CHECK(r.end(far).state == state_kind::cancelled);
}

TEST_CASE("edges at the ends of time fire or wait")
{
    player_lines lines;
    auto input = std::make_unique<scripted_input>(std::vector{earliest, latest});
    const scripted_input& trigger = *input;
    lines.trigger = std::move(input);
    clocked_player p(patient(), std::move(lines));
    const stroke_id first = p.submit(tone(0.01), start_at::trigger());
    trigger.edge();
    CHECK(p.wait(first)->state == state_kind::finished);
    const stroke_id second = p.submit(tone(0.01), start_at::trigger());
    trigger.edge();
    p.stop();
    CHECK(p.wait(second)->state == state_kind::cancelled);
}

TEST_CASE("the longest wait has no end, the shortest does not wait")
{
    clocked_player p;
    const stroke_id id = p.submit(tone(0.1));
    CHECK(p.wait(id, std::numeric_limits<double>::infinity()));
    const stroke_id other = p.submit(tone(0.1), start_at::trigger());
    CHECK_FALSE(p.wait(other, -std::numeric_limits<double>::infinity()));
    p.stop();
}

TEST_CASE("impossible options of the player are errors that name their field")
{
    std::string refused_field;
    const auto refused = [&](const player_options& o, player_lines lines = {}) {
        fake_dac dac;
        try {
            const running_clock clock(dac);
            const player p(alsa::adopt(dac.pcm(), nine()), palm(), o, std::move(lines));
        } catch (const error& e) {
            refused_field = e.subject();
            return e.kind() == error_kind::bad_input && dac.closed();
        }
        return false;
    };
    for (const double bad : {nan, infinity, -infinity, -1.0, -0.001, 1e9, 1e308}) {
        CAPTURE(bad);
        for (const auto& [field, name] :
             {std::pair(&player_options::horizon_s, "horizon_s"),
              std::pair(&player_options::fade_s, "fade_s"), std::pair(&player_options::stall_s, "stall_s")}) {
            player_options o = patient();
            o.*field = bad;
            CHECK(refused(o));
            CHECK(refused_field == name);
        }
        for (const auto& [field, name] :
             {std::pair(&player_lines::settle_s, "settle_s"), std::pair(&player_lines::pulse_s, "pulse_s"),
              std::pair(&player_lines::trigger_delay_s, "trigger_delay_s")}) {
            player_lines lines;
            lines.*field = bad;
            CHECK(refused(patient(), std::move(lines)));
            CHECK(refused_field == name);
        }
    }
    for (const auto& [field, name] : {std::pair(&drive_limits::power_dbfs, "power_dbfs"),
                                      std::pair(&drive_limits::max_drive_s, "max_drive_s"),
                                      std::pair(&drive_limits::window_s, "window_s")}) {
        player_options o = patient();
        o.limits.*field = nan;
        CHECK(refused(o));
        CHECK(refused_field == name);
    }
}

TEST_CASE("the player accepts any priority")
{
    for (const int priority : {std::numeric_limits<int>::min(), -1, 0, std::numeric_limits<int>::max()}) {
        player_options o = patient();
        o.priority = priority;
        clocked_player p(o);
        CHECK(p.wait(p.submit(tone(0.001)))->state == state_kind::finished);
        p.stop();
    }
}

TEST_CASE("a live stroke refuses impossible numbers, and goes on where it was")
{
    clocked_player p;
    for (const double bad : absurd) {
        CAPTURE(bad);
        live_options o;
        o.timeout_s = bad;
        CHECK_THROWS_AS(p.begin(o), error);
        o = {};
        o.plan.carrier_hz = bad;
        CHECK_THROWS_AS(p.begin(o), error);
        o = {};
        o.render.ramp_s = bad;
        CHECK_THROWS_AS(p.begin(o), error);
        o = {};
        o.plan.algorithm = algorithm_kind::park2016;
        o.plan.soa_s = bad;
        CHECK_THROWS_AS(p.begin(o), error);
        o = {};
        o.render.level_dbfs = bad;
        CHECK(no_harm([&] { p.begin(o).cancel(); }));
    }
    live_stroke live = p.begin({.timeout_s = 86400.0});
    CHECK(live.to(1.0, 1.0));
    for (const double bad : absurd) {
        CAPTURE(bad);
        CHECK(no_harm([&] { live.to(bad, 1.0); }));
        CHECK(no_harm([&] { live.to(1.0, bad); }));
        CHECK_THROWS_AS(live.to(1.0, 1.0, bad == 1e308 ? nan : bad), error);
        CHECK(no_harm([&] { live.to(1.0, 1.0, bad); }));
    }
    CHECK(live.to(1.0, 1.0));
    live.end();
    CHECK(p.wait(live.id())->state == state_kind::finished);
    p.stop();
}

TEST_CASE("values of absurd numbers give an error, or something finite")
{
    const std::vector<point> corners{{0.0, 0.0}, {40.0, 30.0}, {0.0, 40.0}};
    const path p = path::polyline(corners);
    const trajectory t = trajectory::along(p, 1.0);
    const trajectory timed = trajectory::timed({{0.0, {}, 1.0}, {1.0, {40.0, 40.0}, 1.0}});
    const array a = palm();
    const layout l(a);
    const auto finite = [](point q) { return std::isfinite(q.x_mm) && std::isfinite(q.y_mm); };
    for (const double bad : absurd) {
        CAPTURE(bad);
        CHECK(finite(p.at(bad)));
        CHECK(no_harm([&] { static_cast<void>(p.meets_x(bad)); }));
        CHECK(no_harm([&] { static_cast<void>(p.meets_y(bad)); }));
        for (const trajectory& m : {t, timed}) {
            CHECK(finite(m.position(bad)));
            CHECK(std::isfinite(m.intensity(bad)));
            CHECK(no_harm([&] { static_cast<void>(m.meets_x(bad)); }));
            CHECK_THROWS_AS(m.with_duration(bad), error);
            CHECK_THROWS_AS(m.with_intensity(bad), error);
        }
        CHECK_THROWS_AS(trajectory::along(p, bad), error);
        CHECK_THROWS_AS(trajectory::timed({{0.0, {}, 1.0}, {bad, {1.0, 1.0}, 1.0}}), error);
        CHECK(no_harm([&] { static_cast<void>(path::arc({bad, 0.0}, bad, bad, bad)); }));
        CHECK(no_harm([&] {
            static_cast<void>(path::polyline(std::vector<point>{{bad, 0.0}, {0.0, bad}}));
        }));
        CHECK(no_harm([&] { static_cast<void>(l.contains({bad, bad})); }));
        CHECK(no_harm([&] { static_cast<void>(l.nearest({bad, 0.0})); }));
        CHECK(no_harm([&] { layout(make_grid("g", 2, 2, bad, 20.0)); }));
        CHECK(no_harm([&] { static_cast<void>(burst_duration_s({}, bad)); }));
        std::vector<drive> drives;
        for (const phantom_kind k : {phantom_kind::inverse_distance, phantom_kind::barycentric,
                                     phantom_kind::linear, phantom_kind::log, phantom_kind::gaussian}) {
            CHECK(no_harm([&] { make_phantom(k, l)->weights({bad, 0.0}, 1.0, drives); }));
            CHECK(no_harm([&] { make_phantom(k, l)->weights({1.0, 1.0}, bad, drives); }));
        }
    }
}

TEST_CASE("scores of plans with absurd numbers give an error, or can be rendered")
{
    const array a = palm();
    for (const double bad : absurd) {
        CAPTURE(bad);
        const auto with = [&](auto change) {
            plan p;
            p.bursts.push_back({.onset_s = 0.0, .duration_s = 0.01, .drives = {{0, 0.5}}});
            p.total_s = 0.01;
            p.stroke_duration_s = 0.01;
            placed_plan placed{p, 0.0};
            render_options o;
            change(placed, o);
            return no_harm([&] {
                const score s(a, {placed}, o);
                renderer r(s, format_kind::s16);
                std::vector<std::byte> out(std::size_t{480} * s.channels() * 2);
                r.process(out);
            });
        };
        CHECK(with([&](placed_plan& p, render_options&) { p.start_s = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.carrier_hz = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.total_s = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.stroke_duration_s = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.bursts[0].onset_s = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.bursts[0].duration_s = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.bursts[0].intensity = bad; }));
        CHECK(with([&](placed_plan& p, render_options&) { p.plan.bursts[0].drives[0].amplitude = bad; }));
        CHECK(with(
            [&](placed_plan& p, render_options&) { p.plan.bursts[0].drives[0].tactor = 4'000'000'000U; }));
        CHECK(with([&](placed_plan&, render_options& o) { o.level_dbfs = bad; }));
        CHECK(with([&](placed_plan&, render_options& o) { o.sl_db = bad; }));
        CHECK(with([&](placed_plan&, render_options& o) { o.ramp_s = bad; }));
        CHECK(with([&](placed_plan&, render_options& o) { o.limits = drive_limits{.power_dbfs = bad}; }));
        CHECK(with([&](placed_plan&, render_options& o) { o.limits = drive_limits{.max_drive_s = bad}; }));
        CHECK(with([&](placed_plan&, render_options& o) { o.limits = drive_limits{.window_s = bad}; }));
        CHECK(with([&](placed_plan&, render_options& o) {
            o.marker_channel = 12;
            o.channels = 13;
            o.marker_s = bad;
        }));
    }
}

} // namespace player_extremes_test
