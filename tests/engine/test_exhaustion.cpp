// SPDX-License-Identifier: MIT
// Calls without descriptors and memory: an error with the reason, nothing lost or left behind.
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "count_allocations.hpp"
#include "descriptors_left.hpp"
#include "exhaustion_calls.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rounds.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace exhaustion_test {

using namespace tactor;
using namespace tactor::test;

namespace {

std::ptrdiff_t open_descriptors()
{
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
}

// Message of a call's error, "" for none, and its errno.
struct outcome {
    std::string said = {};
    int code = 0;

    friend bool operator==(const outcome&, const outcome&) = default;
};

outcome try_call(const std::function<void()>& call)
{
    try {
        call();
    } catch (const error& e) {
        return {e.what(), e.os_code()};
    } catch (const std::exception& e) {
        return {std::string("not a tactor::error: ") + e.what(), -1};
    } catch (...) {
        return {"something else", -1};
    }
    return {};
}

outcome with_descriptors(unsigned n, const std::function<void()>& call)
{
    const descriptors_left few(n);
    return try_call(call);
}

void prepare(const exhausted_call& c)
{
    if (c.before)
        c.before();
}

// Checks each call of the library that may throw.
void check_calls(const std::function<void(const exhausted_call&)>& check)
{
    const call_things t;
    const auto p = make_player_things();
    for (const call_table& calls :
         {value_calls(t), file_calls(t), plan_calls(t), sound_calls(t), device_calls(), player_calls(*p)})
        for (const exhausted_call& c : calls) {
            CAPTURE(c.name);
            check(c);
        }
}

// Tries a call with more descriptors each time, until it does its work.
void try_without_descriptors(const exhausted_call& c)
{
    prepare(c);
    const outcome usual = try_call(c.call);
    CHECK(usual.code != -1);
    bool refused = true;
    for (unsigned n = 0; refused || n < 6; ++n) {
        CAPTURE(n);
        REQUIRE(n < 20);
        prepare(c);
        const auto before = open_descriptors();
        const outcome o = with_descriptors(n, c.call);
        CHECK(open_descriptors() <= before);
        refused = o != usual;
        if (refused)
            CHECK_MESSAGE(o.code == EMFILE, o.said);
        if (n == 0)
            CHECK(refused == c.opens());
        prepare(c);
        CHECK(try_call(c.call) == usual);
    }
}

// Makes a continuous stroke, each of whose samples needs memory.
score greedy_score(double seconds)
{
    const stroke drawn{"", trajectory::timed({{0.0, {3.0, 2.0}}, {seconds, {37.0, 31.0}}})};
    return {palm(), make_continuous(drawn, faces_kind::nearest)};
}

// Outcome of a call with little memory.
struct outcome_in_need {
    bool no_memory = false;
    std::string said = {};       ///< the message of its error, "" for none
    std::int64_t bytes_kept = 0; ///< where it threw std::bad_alloc

    bool operator==(const outcome_in_need& o) const { return no_memory == o.no_memory && said == o.said; }
};

// Calls with so many allocations granted, and then so many refused.
outcome_in_need try_call(const exhausted_call& c, std::uint64_t granted, std::uint64_t refused)
{
    prepare(c);
    outcome_in_need o;
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
void try_without_memory(const exhausted_call& c, std::uint64_t step)
{
    const outcome_in_need usual = try_call(c, 0, 0);
    CHECK_FALSE(usual.no_memory);
    for (std::uint64_t granted = std::hash<std::string>()(c.name) % step;; granted += step) {
        CAPTURE(granted);
        REQUIRE(granted < 100'000);
        static_cast<void>(try_call(c, granted, UINT64_MAX)); // what is made once, on its way out
        const outcome_in_need all = try_call(c, granted, UINT64_MAX);
        const outcome_in_need one = try_call(c, granted, 1);
        for (const outcome_in_need& o : {all, one}) {
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

} // namespace

EXHAUSTING_TEST_CASE(
    "a player without descriptors gives the reason, leaves none behind, and opens once there are enough")
{
    for (unsigned n = 0;; ++n) {
        CAPTURE(n);
        REQUIRE(n < 20);
        fake_dac dac;
        const running_clock clock(dac);
        std::unique_ptr<sink> out = alsa::adopt(dac.pcm(), nine());
        const auto before = open_descriptors();
        bool played = false;
        const std::string said = with_descriptors(n, [&] {
                                     player p(std::move(out), palm(), patient());
                                     played = p.wait(p.submit(tone(0.001)))->state == state_kind::finished;
                                     p.stop();
                                 }).said;
        CHECK(dac.closed());
        CHECK(open_descriptors() <= before);
        if (played) {
            CHECK(said.empty());
            CHECK(n >= 3);
            break;
        }
        has(said, "player: ");
        has(said, "Too many open files (close some of the files that this process has open, or raise the "
                  "limit: ulimit -n)");
    }
}

EXHAUSTING_TEST_CASE("every call without descriptors does its work, or reports that it was refused one")
{
    check_calls(try_without_descriptors);
}

COUNTING_TEST_CASE("every call without memory reports it at any of its allocations, and works again")
{
    const std::uint64_t step = whole() ? 1 : shortened() ? 101 : 37;
    check_calls([step](const exhausted_call& c) {
        if (!c.ends())
            try_without_memory(c, step);
    });
}

COUNTING_TEST_CASE("a stroke that finds no memory for its level or itself is not played")
{
    const score s = tone(0.1);
    for (const start_at when : {start_at::frame(0), start_at::time(rt::to_time(0)), start_at::trigger()}) {
        engine::link link;
        engine::feeder feed(link, 24'000);
        bool fits = false;
        for (std::uint32_t granted = 0; !fits; ++granted) {
            CAPTURE(granted);
            REQUIRE(granted < 100);
            const stroke_id id{granted + 1};
            refuse_allocations(granted, UINT64_MAX);
            try {
                feed.submit(id, s, when, 0.5F);
                fits = true;
            } catch (const std::bad_alloc&) {
                fits = false;
            }
            refuse_allocations(0, 0);
            CHECK(feed.knows(id) == fits);
        }
    }
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
        const stroke_id id =
            p.submit(s, i % 3 == 0 ? start_at::time(rt::to_time(0)) : start_at::frame(96 * i));
        if (i % 7 == 0)
            p.cancel(id);
    }
    await(ended, strokes);
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
    const score s = greedy_score(1.5);
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
        const bool is_late = without == rate;
        CHECK(r.end(id).reason == (is_late ? reason_kind::late : reason_kind::none));
        if (!is_late)
            CHECK(r.captured(base, s.frames()) == rendered(s, format_kind::s32));
    }
}

COUNTING_TEST_CASE("a renderer without memory goes on where it was")
{
    const score s = greedy_score(0.2);
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

COUNTING_TEST_CASE("the audio loop calls the heap in none of 100 000 periods, xruns and cancels included")
{
    rig r;
    r.dac.reserve_capture(1 << 16);
    std::uint64_t calls = 0;
    const score strokes = random_score(1, 30);
    for (int i = 0; i < 100'000; ++i) {
        if (i % 700 == 0)
            r.submit(strokes, i % 1400 == 0 ? 0 : r.status().written + 5000);
        if (i % 1500 == 0)
            r.feed.cancel(r.last());
        if (i % 9000 == 8999)
            r.dac.advance(10'000);
        r.dac.advance_queued(96);
        {
            const count_allocations count;
            r.step();
            calls += count.calls();
        }
        r.control();
    }
    CHECK(calls == 0);
    CHECK(r.link.count.xruns == 11);
    CHECK(r.link.count.periods >= 100'000);
    CHECK(r.ended.size() > 100);
}

COUNTING_TEST_CASE("the counter counts")
{
    std::uint64_t calls = 0;
    std::int64_t held = 0;
    std::int64_t left = 0;
    {
        const count_allocations count;
        void* volatile p = std::malloc(400); // volatile: the compiler may leave out a pair of calls
        held = count.bytes();
        std::free(p);
        calls = count.calls();
        left = count.bytes();
    }
    CHECK(calls == 2);
    CHECK(held >= 400);
    CHECK(left == 0);
}

} // namespace exhaustion_test
