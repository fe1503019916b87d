// SPDX-License-Identifier: MIT
// Calls without descriptors: an error with the reason, nothing lost or left behind.
#include <cerrno>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

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
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

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

void try_all(const call_table& calls)
{
    for (const exhausted_call& c : calls) {
        CAPTURE(c.name);
        const auto prepare = [&c] {
            if (c.before)
                c.before();
        };
        prepare();
        const outcome usual = try_call(c.call);
        CHECK(usual.code != -1);
        bool refused = true;
        for (unsigned n = 0; refused || n < 6; ++n) {
            CAPTURE(n);
            REQUIRE(n < 20);
            prepare();
            const auto before = open_descriptors();
            const outcome o = with_descriptors(n, c.call);
            CHECK(open_descriptors() <= before);
            refused = o != usual;
            if (refused)
                CHECK_MESSAGE(o.code == EMFILE, o.said);
            if (n == 0)
                CHECK(refused == c.opens());
            prepare();
            CHECK(try_call(c.call) == usual);
        }
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
        has(said, "Too many open files (this process has too many files open: close some, or raise the limit "
                  "(ulimit -n)");
    }
}

EXHAUSTING_TEST_CASE("a PCM without descriptors gives the reason, and opens once there are enough")
{
    alsa_options o = nine();
    o.pcm = "null";
    static_cast<void>(open_alsa(o)); // ALSA keeps its configuration
    for (unsigned n = 0;; ++n) {
        CAPTURE(n);
        REQUIRE(n < 20);
        const auto before = open_descriptors();
        const std::string said = with_descriptors(n, [&] { static_cast<void>(open_alsa(o)); }).said;
        CHECK(open_descriptors() == before);
        if (said.empty())
            break;
        has(said, "Too many open files");
        has(said, "ulimit -n");
    }
}

EXHAUSTING_TEST_CASE("every call without descriptors does its work, or reports that it was refused one")
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

} // namespace exhaustion_test
