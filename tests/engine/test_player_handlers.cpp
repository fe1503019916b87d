// SPDX-License-Identifier: MIT
// Code of the program that the player calls, and that calls the player.
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <exception>
#include <functional>
#include <latch>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_future.hpp>
#include <doctest/doctest.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <tactor/alsa.hpp>
#include <tactor/asio.hpp>
#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/phantom.hpp>
#include <tactor/player.hpp>
#include <tactor/stroke.hpp>

#include "clock_runner.hpp"
#include "engine/live.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace player_handlers_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// An input without edges, with a descriptor of any kind.
class odd_input final : public edge_input {
public:
    explicit odd_input(int fd) : fd_(fd) {}
    int descriptor() const noexcept override { return fd_; }
    std::optional<gpio_edge> read() noexcept override { return std::nullopt; }

private:
    int fd_;
};

std::string refused_trigger(int fd, int code = 0)
{
    fake_dac dac;
    const running_clock clock(dac);
    player_lines lines{.trigger = std::make_unique<odd_input>(fd)};
    try {
        const player p(alsa::adopt(dac.pcm(), nine()), palm(), patient(), std::move(lines));
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        CHECK(e.os_code() == code);
        CHECK(dac.closed());
        return e.what();
    }
    return "no error";
}

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

/// A phantom model that does the same, also at each of its calls.
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

live_options asking_options(const player& p, std::atomic<int>& gone)
{
    live_options o{.timeout_s = 86400.0};
    o.plan.custom_phantom = std::make_shared<asking_model>(p, gone);
    return o;
}

} // namespace

TEST_CASE(
    "a handler may destroy the player: the other strokes are reported from within, and the device is closed")
{
    for (const bool own : {false, true}) {
        CAPTURE(own);
        fake_dac dac;
        const running_clock clock(dac);
        std::latch submitted(1);
        std::latch gone(1);
        std::vector<stroke_report> told;
        auto p = std::make_unique<player>(alsa::adopt(dac.pcm(), nine()), palm(), patient());
        const auto destroy = [&](const stroke_report& r) {
            told.push_back(r);
            if (p == nullptr)
                return;
            submitted.wait();
            p.reset();
            CHECK(told.size() == 3);
            CHECK(dac.closed());
            gone.count_down();
        };
        const stroke_id armed = p->submit(tone(0.01), start_at::trigger());
        const stroke_id sounding = p->submit(tone(endless_s));
        const stroke_id first = p->submit(tone(0.01), start_at::trigger());
        if (own)
            for (const stroke_id id : {armed, sounding, first})
                CHECK(p->on_end(id, destroy));
        else
            p->on_report(destroy);
        p->cancel(first);
        submitted.count_down();
        gone.wait();
        REQUIRE(told.size() == 3);
        CHECK(told[0].id == first);
        CHECK(told[0].state == state_kind::cancelled);
        for (std::size_t i = 1; i < 3; ++i) {
            CHECK(told[i].state == state_kind::interrupted);
            CHECK(told[i].why == "the player was closed");
            CHECK(told[i].reason == reason_kind::closed);
        }
    }
}

TEST_CASE("a handler that destroys the player: the stroke's other handlers are called before that is done")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::latch submitted(1);
    std::latch gone(1);
    int others = 0;
    auto p = std::make_unique<player>(alsa::adopt(dac.pcm(), nine()), palm(), patient());
    p->on_report([&](const stroke_report&) {
        submitted.wait();
        p.reset();
        CHECK(others == 2);
        gone.count_down();
    });
    const stroke_id id = p->submit(tone(0.01), start_at::trigger());
    for (int i = 0; i < 2; ++i)
        CHECK(p->on_end(id, [&](const stroke_report&) { ++others; }));
    p->cancel(id);
    submitted.count_down();
    gone.wait();
    CHECK(others == 2);
}

TEST_CASE("a handler that throws ends the stream with the reason, and not the program")
{
    for (const bool own : {false, true}) {
        CAPTURE(own);
        clocked_player p;
        const std::string why = "a handler of the program threw: no such file";
        std::atomic<int> others{0};
        const auto throws = [](const stroke_report&) { throw std::runtime_error("no such file"); };
        const stroke_id longer = p.submit(tone(endless_s));
        const stroke_id armed = p.submit(tone(0.01), start_at::trigger());
        const stroke_id id = p.submit(tone(100.0, 3));
        if (own)
            CHECK(p.on_end(id, throws));
        else
            p.on_report(throws);
        CHECK(p.on_end(longer, [&](const stroke_report&) { ++others; }));
        CHECK(p.on_end(armed, [&](const stroke_report&) { ++others; }));
        CHECK(p.cancel(id));
        CHECK(p.wait(id)->state == state_kind::cancelled);
        for (const stroke_id other : {longer, armed}) {
            const auto r = p.wait(other);
            REQUIRE(r);
            CHECK(r->state == state_kind::interrupted);
            CHECK(r->reason == reason_kind::handler);
            CHECK(r->why == why);
        }
        p.stop();
        CHECK(others == 2);
        REQUIRE(p.ended());
        CHECK(p.ended()->reason == reason_kind::handler);
        CHECK(p.ended()->why == why);
        CHECK_THROWS_WITH_AS(p.submit(tone(0.01)), doctest::Contains(why.c_str()), error);
    }
}

TEST_CASE("a handler may throw anything; an on_end() that calls at once throws to its caller")
{
    clocked_player p;
    std::latch ended(1);
    std::latch told(1);
    p.on_report([&](const stroke_report&) { told.count_down(); });
    const stroke_id id = p.submit(tone(0.001));
    CHECK(p.on_end(id, [&](const stroke_report&) { ended.count_down(); }));
    ended.wait();
    told.wait(); // or the handler below could get this stroke's report, too
    CHECK_THROWS_AS(p.on_end(id, [](const stroke_report&) { throw 17; }), int);
    CHECK_FALSE(p.ended());
    p.on_report([](const stroke_report&) { throw 17; });
    const stroke_id other = p.submit(tone(0.001));
    CHECK(p.wait(other)->state == state_kind::finished);
    // The report may arrive before the handler is set.
    while (!p.ended())
        std::this_thread::yield();
    p.stop();
    CHECK(p.ended()->why == "a handler of the program threw: not a std::exception");
}

TEST_CASE("a handler may call all members, and replace itself")
{
    clocked_player p;
    std::latch first(1);
    std::latch second(1);
    p.on_report([&](const stroke_report& r) {
        const stroke_id armed = p.submit(tone(0.001), start_at::trigger());
        CHECK(p.on_end(armed, [&](const stroke_report&) { second.count_down(); }));
        CHECK_FALSE(p.on_end({r.id.number + 1000}, [](const stroke_report&) {}));
        CHECK_FALSE(p.ended());
        CHECK(p.setup().channels == 9);
        CHECK(p.stats().xruns == 0);
        CHECK(p.position().running);
        CHECK_FALSE(p.cancel(r.id));
        CHECK(p.wait(armed).outcome() == wait_kind::timeout); // a handler does not wait for itself
        live_stroke live = p.begin({.timeout_s = 86400.0});
        CHECK(live.to(1.0, 1.0));
        live.cancel();
        p.on_report({});
        CHECK(p.fire({}) == 1);
        first.count_down();
    });
    const stroke_id id = p.submit(tone(0.001));
    first.wait();
    second.wait();
    CHECK(p.wait(id)->state == state_kind::finished);
    p.stop();
}

TEST_CASE("after the end all members may be called, and an empty function is refused")
{
    clocked_player p;
    CHECK_THROWS_AS(p.on_end({1}, {}), error);
    live_stroke live = p.begin();
    const stroke_id id = p.submit(tone(endless_s));
    p.stop();
    p.stop();
    CHECK_THROWS_AS(p.submit(tone(0.01)), error);
    CHECK_THROWS_AS(p.submit(tone(0.01), start_at::trigger()), error);
    CHECK_THROWS_AS(p.begin(), error);
    CHECK(p.fire({}) == 0);
    CHECK_FALSE(p.cancel(id));
    CHECK_FALSE(live.to(1.0, 1.0));
    CHECK(p.wait(id)->state == state_kind::cancelled);
    CHECK(p.wait(id).outcome() == wait_kind::taken);
    CHECK_FALSE(p.on_end(id, [](const stroke_report&) {}));
    REQUIRE(p.ended());
    CHECK(p.ended()->reason == reason_kind::none);
    CHECK(p.ended()->why.empty());
    CHECK_FALSE(p.position().running);
    CHECK(p.stats().frames > 0);
    p.on_report([](const stroke_report&) {});
}

TEST_CASE("a trigger whose descriptor is not open is an error")
{
    has(refused_trigger(-1, EBADF), "trigger: its descriptor -1: Bad file descriptor");
    has(refused_trigger(1 << 30, EBADF), "Bad file descriptor");
    const int event = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    CHECK(refused_trigger(event) == "no error");
    ::close(event);
}

TEST_CASE("Asio: a plain callback runs in the named context, which stays at work until then")
{
    clocked_player p;
    const auto here = std::this_thread::get_id();
    int calls = 0;
    const auto ran = [&](std::exception_ptr failed, const stroke_report& r) {
        CHECK(std::this_thread::get_id() == here);
        CHECK_FALSE(failed);
        CHECK(r.state == state_kind::finished);
        ++calls;
    };
    boost::asio::io_context io;
    async_play(io, p, tone(0.01), start_at::now(), ran);
    CHECK(io.run() > 0);
    CHECK(calls == 1);
    io.restart();
    async_wait(boost::asio::make_strand(io), p, p.submit(tone(0.01)), ran);
    CHECK(io.run() > 0);
    CHECK(calls == 2);

    // A callback bound to another context runs there.
    boost::asio::io_context other;
    io.restart();
    async_play(io, p, tone(0.01), start_at::now(), boost::asio::bind_executor(other, ran));
    io.run();
    CHECK(calls == 2);
    CHECK(other.run() > 0);
    CHECK(calls == 3);

    io.restart();
    std::exception_ptr unknown;
    async_wait(io, p, stroke_id{77},
               [&](std::exception_ptr failed, const stroke_report&) { unknown = failed; });
    CHECK_FALSE(unknown);
    io.run();
    CHECK_THROWS_AS(std::rethrow_exception(unknown), error);
    async_play(p, tone(0.001), start_at::now(), boost::asio::detached);
    p.stop();
}

TEST_CASE("Asio: the compiler refuses callbacks without a context")
{
    const auto plain = [](std::exception_ptr, const stroke_report&) {};
    boost::asio::io_context io;
    CHECK(detail::runs_nowhere<decltype(plain)>);
    CHECK_FALSE(detail::runs_nowhere<decltype(boost::asio::bind_executor(io, plain))>);
    CHECK_FALSE(detail::runs_nowhere<decltype(boost::asio::use_future)>);
    CHECK_FALSE(detail::runs_nowhere<decltype(boost::asio::detached)>);
}

TEST_CASE("each stroke's beginning is reported once and before its end, with the time that its report has")
{
    std::mutex mutex;
    std::map<stroke_id, std::vector<std::optional<std::int64_t>>> begun;
    std::map<stroke_id, bool> ended;
    dac_player p;
    bool before = true;
    p.on_begin([&](stroke_id id, std::optional<std::int64_t> at_ns) {
        const std::lock_guard lock(mutex);
        before = before && !ended[id];
        begun[id].push_back(at_ns);
    });
    p.on_report([&](const stroke_report& r) {
        const std::lock_guard lock(mutex);
        ended[r.id] = true;
    });
    const running_clock clock(p.dac);
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    CHECK(live.id().number != 0);
    std::vector<stroke_id> ids{live.id()};
    auto moved = live;
    REQUIRE(moved.to(20.0, 20.0));
    for (unsigned i = 1; i < 20; ++i)
        ids.push_back(p.submit(random_score(i, 3)));
    const stroke_id waits = p.submit(random_score(99, 3), start_at::trigger());
    for (std::size_t i = 1; i < ids.size(); ++i)
        CHECK(p.wait(ids[i])->state == state_kind::finished);
    moved.end();
    CHECK(p.wait(live.id()));
    p.cancel(waits);
    CHECK(p.wait(waits));
    p.stop();
    const std::lock_guard lock(mutex);
    CHECK(before);
    CHECK(begun.size() == ids.size());
    for (const stroke_id id : ids)
        CHECK(begun[id].size() == 1);
    CHECK_FALSE(begun.contains(waits));
}

TEST_CASE("a handler of beginnings that throws ends the stream, as others do")
{
    dac_player p;
    p.on_begin([](stroke_id, std::optional<std::int64_t>) { throw 1; });
    const running_clock clock(p.dac);
    // An endless one: another may have finished before the handler is called.
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    auto moved = live;
    REQUIRE(moved.to(20.0, 20.0));
    CHECK(p.wait(live.id())->state == state_kind::interrupted);
    p.stop();
    CHECK(p.ended()->why.find("handler") != std::string::npos);
}

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
        p.fire({});
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
        CHECK_THROWS_WITH_AS(moved(), doctest::Contains("its phantom model moves the stroke"), error);
        CHECK_FALSE(moved());
        const auto report = p.wait(s->id());
        CHECK(report->state == state_kind::interrupted);
        CHECK(report->why.find("its phantom model moves the stroke") != std::string::npos);

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

} // namespace player_handlers_test
