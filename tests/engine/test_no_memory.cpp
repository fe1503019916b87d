// SPDX-License-Identifier: MIT
// Calls without memory: std::bad_alloc, or an error with the reason; nothing lost or left behind.
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "count_allocations.hpp"
#include "exhaustion_calls.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rounds.hpp"
#include "scores.hpp"

namespace no_memory_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Repeats a call with more memory each time, until it succeeds.
template <typename Call>
std::uint64_t until_it_fits(Call call)
{
    for (std::uint64_t granted = 0;; ++granted) {
        REQUIRE(granted < 100'000);
        refuse_allocations(granted, UINT64_MAX);
        bool fits = false;
        try {
            call();
            fits = true;
        } catch (const std::bad_alloc&) {
            fits = false;
        } catch (...) {
            refuse_allocations(0, 0);
            throw;
        }
        refuse_allocations(0, 0);
        if (fits)
            return granted;
    }
}

// Outcome of a call: the message of its error, "" for none.
struct outcome {
    bool no_memory = false;
    std::string said = {};
    std::int64_t bytes_kept = 0; ///< where it threw std::bad_alloc

    bool operator==(const outcome& o) const { return no_memory == o.no_memory && said == o.said; }
};

// Calls with so many allocations granted, and then so many refused.
outcome try_call(const exhausted_call& c, std::uint64_t granted, std::uint64_t refused)
{
    if (c.before)
        c.before();
    outcome o;
    const auto says = [&o](const char* what, const char* before = "") {
        refuse_allocations(0, 0);
        o.said = std::string(before) + what;
    };
    const count_allocations counted;
    refuse_allocations(granted, refused);
    try {
        c.call();
    } catch (const std::bad_alloc&) {
        o.no_memory = true;
    } catch (const error& e) {
        says(e.what());
        o.no_memory = e.os_code() == ENOMEM;
    } catch (const std::exception& e) {
        says(e.what(), "not a tactor::error: ");
    } catch (...) {
        says("something else");
    }
    refuse_allocations(0, 0);
    if (o.no_memory && o.said.empty())
        o.bytes_kept = counted.bytes();
    return o;
}

// Tries a call with all allocations after the n-th refused, and with only that one, for one n in `step`, from
// one on that its name says.
void try_without(const exhausted_call& c, std::uint64_t step)
{
    const outcome usual = try_call(c, 0, 0);
    CHECK_FALSE(usual.no_memory);
    for (std::uint64_t granted = std::hash<std::string>()(c.name) % step;; granted += step) {
        CAPTURE(granted);
        REQUIRE(granted < 100'000);
        static_cast<void>(try_call(c, granted, UINT64_MAX)); // what is made once, on its way out
        const outcome all = try_call(c, granted, UINT64_MAX);
        const outcome one = try_call(c, granted, 1);
        for (const outcome& o : {all, one}) {
            const bool well = o.no_memory || o == usual;
            CHECK_MESSAGE(well, o.said);
            CHECK(o.bytes_kept <= 0);
            if (!well)
                return;
        }
        if (!all.no_memory)
            return;
        CHECK(try_call(c, 0, 0) == usual);
    }
}

void try_all(const call_table& calls)
{
    const std::uint64_t step = whole() ? 1 : shortened() ? 101 : 17;
    for (const exhausted_call& c : calls) {
        CAPTURE(c.name);
        if (!c.ends())
            try_without(c, step);
    }
}

} // namespace

COUNTING_TEST_CASE("without memory a call throws std::bad_alloc and has no effect")
{
    std::map<stroke_id, int> told;
    std::vector<stroke_id> accepted;
    std::mutex mutex;
    clocked_player p;
    p.on_report([&](const stroke_report& r) {
        const std::lock_guard lock(mutex);
        ++told[r.id];
    });
    accepted.reserve(100);
    const score s = tone(0.001);
    std::uint64_t calls = 0;
    for (const start_at when :
         {start_at::now(), start_at::frame(0), start_at::time(0), start_at::trigger()}) {
        calls += until_it_fits([&] { accepted.push_back(p.submit(s, when)); });
        calls += until_it_fits([&] { accepted.push_back(p.submit(s, start_at::trigger())); });
        calls += until_it_fits([&] { p.cancel(accepted.back()); });
    }
    calls += until_it_fits([&] { p.fire(0); });
    calls += until_it_fits([&] {
        live_stroke live = p.begin();
        accepted.push_back(live.id());
        live.to(1.0, 1.0);
        live.end();
    });
    CHECK(calls > 8);
    p.submit(s, start_at::trigger());
    until_it_fits([&] { static_cast<void>(p.on_end(accepted.back(), [](const stroke_report&) {})); });
    until_it_fits([&] { static_cast<void>(p.stats()); });
    until_it_fits([&] { static_cast<void>(p.ended()); });
    until_it_fits([&] { p.stop(); });
    for (const stroke_id id : accepted) {
        CAPTURE(id);
        CHECK(told[id] == 1);
        CHECK(p.wait(id));
    }
}

COUNTING_TEST_CASE("every call without memory reports it at any of its allocations, and works again")
{
    const call_things t;
    try_all(value_calls(t));
    try_all(file_calls(t));
    try_all(plan_calls(t));
    try_all(sound_calls(t));
    try_all(device_calls());
    const auto p = make_player_things();
    try_all(player_calls(*p));
}

COUNTING_TEST_CASE("the player's thread waits for memory: every stroke ends and is reported once")
{
    std::map<stroke_id, int> told;
    std::atomic<unsigned> ended{0};
    clocked_player p;
    p.on_report([&](const stroke_report& r) {
        refuse_allocations(0, 0);
        ++told[r.id];
        ++ended;
        ended.notify_all();
        refuse_allocations(ended % 5, 3); // for the next calls in this thread
    });
    constexpr unsigned strokes = 30;
    const score s = tone(0.002);
    for (unsigned i = 0; i < strokes; ++i) {
        const stroke_id id = p.submit(s, i % 3 == 0 ? start_at::time(0) : start_at::frame(96 * i));
        if (i % 7 == 0)
            p.cancel(id);
    }
    for (unsigned n = ended; n < strokes; n = ended)
        ended.wait(n);
    p.stop();
    CHECK(told.size() == strokes);
    for (const auto& [id, times] : told)
        CHECK(times == 1);
}

COUNTING_TEST_CASE("a stream that ends while one allocation fails ends in order, with a log")
{
    for (std::uint64_t granted = 0; granted < 40; ++granted) {
        CAPTURE(granted);
        player_options o = patient();
        o.log = [](log_kind, std::string_view) {};
        dac_player p(o);
        const running_clock clock(p.dac);
        const stroke_id id = p.submit(tone(3600.0));
        while (!p.position().stroke)
            std::this_thread::yield();
        refuse_allocations(granted, 1);
        p.dac.disconnect();
        while (p.position().running)
            std::this_thread::yield();
        p.stop();
        refuse_allocations(0, 0);
        CHECK(p.wait(id)->state != state_kind::finished);
    }
}

COUNTING_TEST_CASE("a continuous stroke without memory goes on when there is some, and is late otherwise")
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    o.faces = faces_kind::nearest; // each of its samples needs memory
    const stroke drawn{"", trajectory::timed({{0.0, {3.0, 2.0}}, {1.5, {37.0, 31.0}}})};
    const score s(palm(), make_plan(palm(), drawn, o));
    // Half a second is prepared.
    for (const std::uint64_t without : {rate / 4, rate}) {
        CAPTURE(without);
        rig r;
        const std::uint64_t base = r.status().written;
        const stroke_id id = r.submit(s);
        r.play(9600);
        unsigned refused = 0;
        for (std::uint64_t n = 0; n < without; n += r.options.period) {
            r.dac.advance_queued(r.options.period);
            r.step();
            refuse_allocations(0, UINT64_MAX);
            try {
                r.feed.pump(r.status().written, r.link.clock.load());
            } catch (const std::bad_alloc&) {
                ++refused;
            }
            refuse_allocations(0, 0);
        }
        CHECK(refused > 0);
        r.play_out();
        REQUIRE(r.report(id));
        const bool is_late = without == rate;
        CHECK(r.report(id)->state == (is_late ? state_kind::interrupted : state_kind::finished));
        CHECK(r.report(id)->reason == (is_late ? reason_kind::late : reason_kind::none));
        if (!is_late)
            CHECK(r.captured(base, s.frames()) == rendered(s, format_kind::s32));
    }
}

COUNTING_TEST_CASE("a renderer without memory goes on where it was")
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    o.faces = faces_kind::nearest;
    const stroke drawn{"", trajectory::timed({{0.0, {3.0, 2.0}}, {0.2, {37.0, 31.0}}})};
    const score s(palm(), make_plan(palm(), drawn, o));
    renderer r(s, format_kind::s32);
    const std::size_t frame = s.channels() * sample_bytes(format_kind::s32);
    std::vector<std::byte> out(s.frames() * frame);
    unsigned refused = 0;
    while (r.position() < s.frames()) {
        refuse_allocations(refused % 50, 1); // a sample takes some of them
        try {
            r.process(std::span(out).subspan(r.position() * frame));
        } catch (const std::bad_alloc&) {
            ++refused;
        }
        refuse_allocations(0, 0);
    }
    CHECK(refused > 20);
    CHECK(out == rendered(s, format_kind::s32));
}

} // namespace no_memory_test
