// SPDX-License-Identifier: MIT
// A day on the virtual clock: a period costs the same however long the engine has run. Counts work, not time,
// so that the machine's load does not matter.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "count_allocations.hpp"
#include "engine/live.hpp"
#include "rig.hpp"
#include "rounds.hpp"

namespace soak_day_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr unsigned low_rate = 8000;
constexpr unsigned period = 4000;
constexpr unsigned periods_an_hour = 3600 * low_rate / period;

struct work {
    std::uint64_t heap_calls = 0; ///< by both sides
    std::uint64_t audio_heap_calls = 0;
    std::int64_t held = 0; ///< bytes
    std::uint64_t most_drives = 0;
    std::uint64_t drives = 0; ///< summed over the periods
    std::uint64_t most_commands = 0;
    std::uint64_t strokes = 0;
};

score make_stroke(unsigned bursts)
{
    std::vector<burst> all;
    for (unsigned k = 0; k < bursts; ++k)
        all.push_back({.onset_s = 0.07 * k, .duration_s = 0.06, .drives = {{k % 2, 0.5}}});
    return {make_grid("pair", 1, 2, 20.0, 20.0), make_bursts(std::move(all)), {.rate = low_rate}};
}

class day {
public:
    day() : r_(options()), shorter_(make_stroke(5)), longer_(make_stroke(300))
    {
        r_.dac.reserve_capture(1 << 12);
    }

    // Runs an hour that is like every other.
    work hour()
    {
        std::mt19937_64 random(4);
        work w;
        const std::uint32_t before = r_.last_id;
        counted(w, [&] { begin_live(); });
        for (unsigned i = 0; i < periods_an_hour; ++i)
            half_second(i, random, w);
        counted(w, [&] {
            live_->voice.request(engine::live_voice::action::end);
            r_.feed.fire(r_.now);
            for (int i = 0; i < 1000 && r_.ended.size() < r_.last_id - before; ++i)
                r_.play(period);
            w.strokes = r_.ended.size();
            r_.ended.clear();
            live_.reset();
        });
        REQUIRE(w.strokes == r_.last_id - before);
        return w;
    }

    rig& engine() { return r_; }

private:
    static rig_options options()
    {
        rig_options o{.channels = 2, .period = period, .sample_rate = low_rate};
        o.loop.horizon_frames = 3 * period;
        o.dac.rate = low_rate;
        return o;
    }

    template <typename Action>
    static void counted(work& w, Action action)
    {
        const count_allocations count;
        action();
        w.heap_calls += count.calls();
        w.held += count.bytes();
    }

    void begin_live()
    {
        const array a = make_grid("pair", 1, 2, 20.0, 20.0);
        live_options o{.timeout_s = 3600.0};
        live_ = std::make_shared<live_stroke::impl>(r_.next_id(), a, layout(a), r_.out->setup(), o);
        r_.feed.submit(r_.last(), std::shared_ptr<engine::live_voice>(live_, &live_->voice));
    }

    void half_second(unsigned i, std::mt19937_64& random, work& w)
    {
        counted(w, [&] { producers(i, random); });
        r_.dac.advance_queued(period);
        {
            const count_allocations audio;
            r_.step();
            w.audio_heap_calls += audio.calls();
        }
        counted(w, [&] { r_.control(); });
        w.most_commands = std::max<std::uint64_t>(w.most_commands, r_.link.commands.size());
        w.most_drives = std::max<std::uint64_t>(w.most_drives, r_.loop.drives());
        w.drives += r_.loop.drives();
    }

    void producers(unsigned i, std::mt19937_64& random)
    {
        live_->to({static_cast<double>(random() % 20), 0.0}, 1.0);
        if (random() % 4 == 0) {
            const std::uint64_t kind = random() % 5;
            r_.submit(random() % 20 == 0 ? longer_ : shorter_,
                      kind == 0   ? start_at::trigger()
                      : kind == 1 ? start_at::time(r_.now + 3'000'000'000)
                      : kind == 2 ? start_at::frame(r_.status().written + 20'000)
                                  : start_at::now());
        }
        if (random() % 40 == 0)
            r_.feed.fire(r_.now + 1'000'000'000);
        if (random() % 50 == 0)
            r_.feed.cancel(r_.last());
        if (i % 1800 == 1799) {
            r_.dac.advance(100'000); // an xrun every quarter of an hour
            r_.step();
        }
    }

    rig r_;
    score shorter_;
    score longer_;
    std::shared_ptr<live_stroke::impl> live_;
};

} // namespace

TEST_CASE("a day: the last hour costs as much as the second, and nothing is left behind")
{
    day d;
    d.hour();
    const work second = d.hour();
    work last;
    const std::uint64_t hours = soak_length("hours of the day", 24, 4);
    for (std::uint64_t h = 3; h <= hours; ++h) {
        last = d.hour();
        CHECK(last.most_drives <= second.most_drives + second.most_drives / 10);
        CHECK(last.most_commands <= second.most_commands + second.most_commands / 10);
    }
    CHECK(d.engine().status().written > hours * 3600 * low_rate);
    MESSAGE("second and last hour of " << hours << ": " << second.heap_calls << " and " << last.heap_calls
                                       << " heap calls (audio thread: " << second.audio_heap_calls << " and "
                                       << last.audio_heap_calls << "), " << second.drives << " and "
                                       << last.drives << " drives held, " << second.strokes << " and "
                                       << last.strokes << " strokes");
    CHECK(last.strokes == second.strokes);
    CHECK(last.strokes > 1000);
    CHECK(static_cast<double>(last.drives) <= 1.02 * static_cast<double>(second.drives));
    if (!counts_allocations())
        return;
    CHECK(last.audio_heap_calls == 0);
    CHECK(last.heap_calls > 1000);
    CHECK(static_cast<double>(last.heap_calls) <= 1.02 * static_cast<double>(second.heap_calls));
    CHECK(std::abs(last.held) < 4096);
}

} // namespace soak_day_test
