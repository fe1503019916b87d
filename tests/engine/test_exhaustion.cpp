// SPDX-License-Identifier: MIT
// When descriptors or memory run out: an error that says so, or std::bad_alloc; and nothing is lost or left
// behind.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/array.hpp>
#include <tactor/devices.hpp>
#include <tactor/error.hpp>
#include <tactor/fit.hpp>
#include <tactor/gpio.hpp>
#include <tactor/path.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/player.hpp>
#include <tactor/realtime.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>
#include <tactor/wav.hpp>

#include "clock_runner.hpp"
#include "count_allocations.hpp"
#include "descriptors_left.hpp"
#include "folder.hpp"
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

// What a call throws with so many descriptors: "" for nothing.
std::string said_with(unsigned descriptors, const std::function<void()>& call)
{
    const descriptors_left few(descriptors);
    try {
        call();
    } catch (const error& e) {
        return e.what();
    } catch (const std::exception& e) {
        return std::string("not a tactor::error: ") + e.what();
    }
    return "";
}

// Calls again and again with more memory each time, until there is enough.
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

} // namespace

EXHAUSTING_TEST_CASE(
    "a player without descriptors says so, leaves none behind, and opens once there are enough")
{
    for (unsigned n = 0;; ++n) {
        CAPTURE(n);
        REQUIRE(n < 20);
        fake_dac dac;
        const running_clock clock(dac);
        std::unique_ptr<sink> out = pcm::adopt(dac.pcm(), nine());
        const auto before = open_descriptors();
        bool played = false;
        const std::string said = said_with(n, [&] {
            player p(std::move(out), palm(), patient());
            played = p.wait(p.submit(tone(0.001)))->state == state_kind::finished;
            p.stop();
        });
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

EXHAUSTING_TEST_CASE("a PCM without descriptors says so, and opens once there are enough")
{
    alsa_options o = nine();
    o.pcm = "null";
    static_cast<void>(open_alsa(o)); // ALSA keeps its configuration
    for (unsigned n = 0;; ++n) {
        CAPTURE(n);
        REQUIRE(n < 20);
        const auto before = open_descriptors();
        const std::string said = said_with(n, [&] { static_cast<void>(open_alsa(o)); });
        CHECK(open_descriptors() == before);
        if (said.empty())
            break;
        has(said, "Too many open files");
        has(said, "ulimit -n");
    }
}

EXHAUSTING_TEST_CASE("every call without descriptors throws what it documents")
{
    const folder here;
    const auto array_file =
        here.write("a.toml", "[array]\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n");
    const auto stroke_file = here.write("s.csv", "t_s,x_mm,y_mm\n0,0,0\n1,10,0\n");
    const gpio_line_name line{.name = "no-such-line"};
    const std::vector<std::pair<const char*, std::function<void()>>> calls{
        {"open_alsa", [] { static_cast<void>(open_alsa(nine())); }},
        {"hw", [] { static_cast<void>(open_alsa({.pcm = "hw:0", .channels = 2})); }},
        {"list_pcms", [] { static_cast<void>(list_pcms()); }},
        {"card_of", [] { static_cast<void>(card_of("hw:0")); }},
        {"card_holders", [] { static_cast<void>(card_holders(0)); }},
        {"list_gpio", [] { static_cast<void>(list_gpio()); }},
        {"find_gpio_line", [&] { static_cast<void>(find_gpio_line(line)); }},
        {"open_output", [&] { static_cast<void>(open_output(line)); }},
        {"open_edges", [&] { static_cast<void>(open_edges(line, edge_kind::rising)); }},
        {"open_amplifier", [&] { static_cast<void>(open_amplifier({.line = line})); }},
        {"probe_realtime_rights", [] { static_cast<void>(probe_realtime_rights()); }},
        {"load_strokes", [&] { static_cast<void>(load_strokes(stroke_file)); }},
    };
    for (const auto& [name, call] : calls) {
        for (unsigned n = 0; n < 6; ++n) {
            CAPTURE(name);
            CAPTURE(n);
            const std::string said = said_with(n, call);
            CHECK(said.find("not a tactor::error") == std::string::npos);
        }
    }
}

COUNTING_TEST_CASE("without memory a call throws std::bad_alloc and has done nothing")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::map<stroke_id, int> told;
    std::vector<stroke_id> accepted;
    std::mutex mutex;
    player p(pcm::adopt(dac.pcm(), nine()), palm(), patient());
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

// Not among them: what reads TOML. The parser of toml++ 3 is noexcept where it allocates, and ends the
// process.
COUNTING_TEST_CASE("every call without memory throws std::bad_alloc, at each of its allocations")
{
    const folder here;
    const array a = palm();
    const layout l(a);
    const stroke s = preset_stroke("park2016-1");
    const plan p = make_plan(a, s);
    const std::string csv = "t_s,x_mm,y_mm\n0,0,0\n1,10,0\n";
    const std::string svg =
        R"(<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">)"
        R"(<path d="M 0 10 L 40 30"/></svg>)";
    const auto stroke_file = here.write("s.csv", csv);
    const auto planned = [&](algorithm_kind k) {
        return [&, k] {
            plan_options o;
            o.algorithm = k;
            static_cast<void>(make_plan(a, s, o));
        };
    };
    const std::vector<std::pair<const char*, std::function<void()>>> calls{
        {"make_grid", [] { static_cast<void>(make_grid("a", 2, 3, 20.0, 20.0)); }},
        {"preset_array", [] { static_cast<void>(preset_array("palm-3x3")); }},
        {"find_grid", [&] { static_cast<void>(find_grid(a)); }},
        {"validate", [&] { validate(a); }},
        {"layout", [&] { const layout made(a); }},
        {"make_phantom", [&] { static_cast<void>(make_phantom(phantom_kind::barycentric, l)); }},
        {"from_svg", [] { static_cast<void>(path::from_svg("M 0 10 C 20 -5 20 45 40 30")); }},
        {"arc",
         [] {
             static_cast<void>(path::arc({0.0, 0.0}, 10.0, 0.0, 90.0));
         }},
        {"preset_stroke", [] { static_cast<void>(preset_stroke("park2016-4")); }},
        {"parse_strokes_csv", [&] { static_cast<void>(parse_strokes_csv(csv, "s.csv")); }},
        {"parse_strokes_svg", [&] { static_cast<void>(parse_strokes_svg(svg, "s.svg")); }},
        {"load_strokes", [&] { static_cast<void>(load_strokes(stroke_file)); }},
        {"fit_strokes", [&] { static_cast<void>(fit_strokes({s}, l, {})); }},
        {"park2016", planned(algorithm_kind::park2016)},
        {"tactile brush", planned(algorithm_kind::tactile_brush)},
        {"continuous", planned(algorithm_kind::continuous)},
        {"predict_percept", [&] { static_cast<void>(summarise(predict_percept(a, s, p))); }},
        {"renderer",
         [&] {
             const score piece(a, {{p}}, {});
             renderer r(piece, format_kind::s16);
         }},
        {"write_wav", [&] { write_wav(score(a, p), format_kind::s16, here.path() / "x.wav"); }},
    };
    for (const auto& [name, call] : calls) {
        CAPTURE(name);
        CHECK(until_it_fits(call) > 0);
    }
}

COUNTING_TEST_CASE("the player's own thread waits for memory: every stroke ends, and is told once")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::map<stroke_id, int> told;
    std::atomic<unsigned> ended{0};
    player p(pcm::adopt(dac.pcm(), nine()), palm(), patient());
    p.on_report([&](const stroke_report& r) {
        refuse_allocations(0, 0);
        ++told[r.id];
        ++ended;
        ended.notify_all();
        refuse_allocations(ended % 5, 3); // what comes next in this thread
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

} // namespace exhaustion_test
