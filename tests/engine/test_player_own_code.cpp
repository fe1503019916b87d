// SPDX-License-Identifier: MIT
// Code of the program that calls the player while it is destroyed: handlers' captures, phantom models.
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/live.hpp>
#include <tactor/path.hpp>
#include <tactor/phantom.hpp>
#include <tactor/player.hpp>
#include <tactor/stroke.hpp>

#include "clock_runner.hpp"
#include "engine/live/live_voice.hpp"
#include "player_support.hpp"
#include "scores.hpp"

namespace player_own_code_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// Asks the player for its position when it is destroyed.
class asking {
public:
    asking(const player& p, std::atomic<int>& gone) : player_(&p), gone_(&gone) {}
    ~asking()
    {
        static_cast<void>(player_->position());
        ++*gone_;
        gone_->notify_all();
    }
    asking(const asking&) = delete;
    asking& operator=(const asking&) = delete;

private:
    const player* player_;
    std::atomic<int>* gone_;
};

/// The same, also whenever it is asked for something.
class asking_model final : public phantom_model {
public:
    asking_model(const player& p, std::atomic<int>& gone) : player_(&p), goes_(p, gone) {}
    std::string_view name() const noexcept override
    {
        static_cast<void>(player_->position());
        return "asking";
    }
    void weights(point, double a_v, std::vector<drive>& out) const override
    {
        static_cast<void>(player_->position());
        out.clear();
        out.push_back({.tactor = 4, .amplitude = a_v});
    }

private:
    const player* player_;
    asking goes_;
};

/// Acts on the stroke that asks it.
class meddling_model final : public phantom_model {
public:
    explicit meddling_model(std::function<void()> f) : does_(std::move(f)) {}
    std::string_view name() const noexcept override { return "meddling"; }
    void weights(point, double a_v, std::vector<drive>& out) const override
    {
        does_();
        out = {{.tactor = 4, .amplitude = a_v}};
    }

private:
    std::function<void()> does_;
};

void await(const std::atomic<int>& n, int wanted)
{
    for (int seen = n; seen < wanted; seen = n)
        n.wait(seen);
}

live_options asking_options(const player& p, std::atomic<int>& gone)
{
    live_options o{.timeout_s = 86400.0};
    o.plan.custom_phantom = std::make_shared<asking_model>(p, gone);
    return o;
}

} // namespace

TEST_CASE("objects that a handler holds may call the player when they are destroyed")
{
    std::atomic<int> gone{0};
    dac_player p;
    const running_clock clock(p.dac);
    SUBCASE("of one stroke's end")
    {
        const stroke_id id = p.submit(tone(0.01), start_at::trigger());
        for (int i = 0; i < 2; ++i)
            REQUIRE(p.on_end(id, [held = std::make_shared<asking>(p, gone)](const stroke_report&) {}));
        p.fire(0);
        await(gone, 2);
    }
    SUBCASE("of beginnings, replaced by itself")
    {
        p.on_begin([&p, held = std::make_shared<asking>(p, gone)](stroke_id, auto) { p.on_begin({}); });
        p.submit(tone(0.01));
        await(gone, 1);
    }
    SUBCASE("of all ends, replaced by itself")
    {
        p.on_report(
            [&p, held = std::make_shared<asking>(p, gone)](const stroke_report&) { p.on_report({}); });
        p.submit(tone(0.01));
        await(gone, 1);
    }
    p.stop();
}

TEST_CASE("a phantom model may call the player when it is asked and when it is destroyed")
{
    std::atomic<int> gone{0};
    dac_player p;
    SUBCASE("of a continuous stroke")
    {
        const running_clock clock(p.dac);
        const auto line = trajectory::along(path::from_svg("M 0 0 L 40 40"), 0.1);
        plan_options o{.algorithm = algorithm_kind::continuous,
                       .custom_phantom = std::make_shared<asking_model>(p, gone)};
        const stroke_id id = p.submit(score(palm(), make_plan(palm(), stroke{"line", line}, o)));
        CHECK(p.wait(id)->state == state_kind::finished);
        o = {};
        await(gone, 1);
        p.stop();
    }
    SUBCASE("of a live stroke that sounded")
    {
        const running_clock clock(p.dac);
        stroke_id id;
        {
            live_stroke s = p.begin(asking_options(p, gone));
            id = s.id();
            REQUIRE(s.to(20.0, 20.0));
            s.end();
        }
        CHECK(p.wait(id)->state == state_kind::finished);
        await(gone, 1);
        p.stop();
    }
    SUBCASE("of live strokes that did not begin: cancelled, or ended with the stream")
    {
        std::vector<live_stroke> playing; // all places, so that the others wait
        for (std::size_t i = 0; i < engine::live_places; ++i)
            REQUIRE(playing.emplace_back(p.begin(asking_options(p, gone))).to(20.0, 20.0));
        const stroke_id first = p.begin(asking_options(p, gone)).id();
        const stroke_id second = p.begin(asking_options(p, gone)).id();
        CHECK(p.cancel(first));
        await(gone, 1);
        const running_clock clock(p.dac);
        p.stop();
        CHECK(p.wait(second)->state == state_kind::cancelled);
        playing.clear();
        await(gone, engine::live_places + 2);
    }
}

TEST_CASE("a phantom model that moves its own stroke is refused and ends it; it may end the stroke")
{
    dac_player p;
    const running_clock clock(p.dac);
    for (const double smooth_s : {0.0, 0.05}) {
        std::optional<live_stroke> s;
        std::function<void()> does = [&s] { s->to(20.0, 20.0); };
        live_options o{.timeout_s = 86400.0, .smooth_s = smooth_s};
        o.plan.custom_phantom = std::make_shared<meddling_model>([&does] { does(); });
        s.emplace(p.begin(o));
        const auto moved = [&s] { return s->to(10.0, 10.0); };
        CHECK_THROWS_WITH_AS(moved(), doctest::Contains("its phantom model moves it"), error);
        CHECK_FALSE(moved());
        const auto report = p.wait(s->id());
        CHECK(report->state == state_kind::interrupted);
        CHECK(report->why.find("its phantom model moves it") != std::string::npos);

        does = [&s] {
            static_cast<void>(s->counts());
            if (s->open())
                s->end();
        };
        s.emplace(p.begin(o));
        CHECK(moved());
        CHECK_FALSE(moved());
        CHECK(p.wait(s->id())->state == state_kind::finished);
    }
    p.stop();
}

} // namespace player_own_code_test
