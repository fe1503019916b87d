// SPDX-License-Identifier: MIT
// Long runs on the virtual clock, of a day and with faults. They count work, not time, so that the machine's
// load does not matter.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <span>
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
        counted(w, [&] {
            const array a = make_grid("pair", 1, 2, 20.0, 20.0);
            live_ = r_.begin_live(a, {.timeout_s = 3600.0});
        });
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
                      : kind == 1 ? start_at::time(rt::to_time(r_.now + 3'000'000'000))
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

namespace soak_faults_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr unsigned channels = 4;
constexpr unsigned period = 16;
constexpr double limit = 0.5;
constexpr std::uint64_t seed = 20'260'101;

// Checks every sample that the device takes, and refuses writes at random.
class checking_sink : public forwarding_sink {
public:
    /// `most`: greatest magnitude; `allowed`: greatest change from frame to frame, read anew each time.
    checking_sink(std::unique_ptr<sink> s, std::mt19937_64& random, double most, const double& allowed)
        : forwarding_sink(std::move(s)), random_(random), limit_(most), allowed_(allowed)
    {
    }

    io_kind prepare() noexcept override
    {
        empty_ = true;
        before_.fill(0.0); // the device made a gap: from zero
        return forwarding_sink::prepare();
    }

    io_result write(std::span<const std::byte> frames) noexcept override
    {
        std::size_t n = frames.size() / setup().frame_bytes();
        // An empty buffer always takes something.
        switch (empty_ ? 63 : random_() % 64) {
        case 0:
            return {io_kind::again, 0, 0};
        case 1:
            return {io_kind::ok, 0, 0};
        case 2:
            n = 1 + random_() % n; // short
            break;
        default:
            break;
        }
        const io_result r = write_first(n, frames);
        empty_ = false;
        for (std::size_t f = 0; f < r.frames; ++f) {
            for (unsigned c = 0; c < channels; ++c) {
                std::int32_t v = 0;
                std::memcpy(&v, frames.data() + (f * channels + c) * 4, 4);
                const double x = v / 2147483648.0;
                beyond_limit += std::abs(x) > limit_ + 1e-9 ? 1U : 0U;
                jumps += std::abs(x - before_[c]) > allowed_ + 1e-6 ? 1U : 0U;
                loudest = std::max(loudest, std::abs(x));
                before_[c] = x;
            }
        }
        return r;
    }

    std::uint64_t beyond_limit = 0;
    std::uint64_t jumps = 0;
    double loudest = 0.0;

private:
    std::mt19937_64& random_;
    double limit_;
    const double& allowed_;
    std::array<double, channels> before_{};
    bool empty_ = true;
};

array row()
{
    array a = make_grid("row", 2, 2, 20.0, 20.0);
    for (tactor_spec& t : a.tactors)
        t.max_dbfs = 20.0 * std::log10(limit);
    return a;
}

// Greatest change from frame to frame of a stroke of these tests: the carrier's slope, and its whole
// amplitude within the shortest ramp, a live stroke's control step or a fade.
double slope(const render_options& o)
{
    return std::pow(10.0, o.level_dbfs / 20.0) * (2.0 * 3.14159265 * 250.0 / rate + 3.14159265 / 2.0 / 48.0);
}

score random_stroke(std::mt19937_64& random, const render_options& o)
{
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<burst> all(1 + random() % 4);
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k].onset_s = 0.05 * static_cast<double>(k);
        all[k].duration_s = 0.008 + 0.06 * uniform(random); // overlapping ones are joined
        for (unsigned t = 0; t < channels; ++t)
            if (random() % 2 == 0)
                all[k].drives.push_back({.tactor = t, .amplitude = uniform(random)});
    }
    return {row(), make_bursts(std::move(all)), o};
}

struct totals {
    std::uint64_t periods = 0;
    std::uint64_t strokes = 0;
    std::uint64_t rigs = 0;
    std::uint64_t xruns = 0;
    std::map<state_kind, std::uint64_t> states;
    double loudest = 0.0;
};

// A device from its start to its end, by stop or by loss.
class life {
public:
    life(std::mt19937_64& random, std::uint64_t most_periods)
        : random_(random), most_periods_(most_periods), r_(make())
    {
        levels_.level_dbfs = -20.0;
        levels_.ramp_s = 0.002; // bursts that overlap and have no ramp are joined with a step
        r_.dac.reserve_capture(1 << 12);
    }

    void run(totals& t)
    {
        for (std::uint64_t i = 0; i < most_periods_ && !r_.loop.over(); ++i) {
            producers();
            trouble();
            if (random_() % 16 != 0)
                r_.dac.advance_queued(period);
            set_allowed();
            r_.step();
            if (random_() % 3 != 0)
                r_.control();
        }
        finish();
        t.periods += r_.link.count.periods;
        t.strokes += r_.last_id;
        t.xruns += r_.link.count.xruns;
        ++t.rigs;
        t.loudest = std::max(t.loudest, sink_->loudest);
        CHECK(sink_->jumps == 0);
        CHECK(sink_->beyond_limit == 0);
        REQUIRE(r_.ended.size() == r_.last_id);
        for (const auto& [id, reports] : r_.ended) {
            REQUIRE(reports.size() == 1);
            ++t.states[reports[0].state];
        }
        for (const auto& l : live_)
            CHECK_FALSE(l->to({0.0, 0.0}, 1.0));
    }

private:
    rig_options make()
    {
        rig_options o{.channels = channels, .period = period, .ring = std::size_t{256} << random_() % 4};
        o.limit = limit;
        o.loop.fade_frames = 48 + static_cast<std::uint32_t>(random_() % 480);
        o.wrap = [this](std::unique_ptr<sink> s) {
            auto c = std::make_unique<checking_sink>(std::move(s), random_, limit, allowed_);
            sink_ = c.get();
            return c;
        };
        return o;
    }

    // Allows one slope for each stroke that has not ended: all of them may sound at once.
    void set_allowed() { allowed_ = static_cast<double>(r_.last_id - r_.ended.size()) * slope(levels_); }

    void producers()
    {
        const bool quiet = r_.last_id - r_.ended.size() > 12;
        if (!quiet && random_() % 60 == 0)
            r_.submit(random_stroke(random_, levels_), when());
        if (!quiet && random_() % 400 == 0)
            begin_live();
        if (random_() % 300 == 0)
            r_.feed.fire(r_.now + static_cast<std::int64_t>(random_() % 100'000'000) - 20'000'000);
        if (random_() % 90 == 0 && r_.last_id > 0)
            r_.feed.cancel({r_.last_id - static_cast<std::uint32_t>(random_() % std::min(r_.last_id, 16U))});
        for (std::size_t i = 0; i < live_.size(); ++i)
            feed_live(i);
    }

    start_at when()
    {
        switch (random_() % 5) {
        case 0:
            return start_at::frame(r_.status().written + random_() % 20'000);
        case 1:
            return start_at::time(
                rt::to_time(r_.now + static_cast<std::int64_t>(random_() % 400'000'000) - 50'000'000));
        case 2:
            return start_at::trigger();
        default:
            return start_at::now();
        }
    }

    void begin_live()
    {
        live_options o;
        o.plan.algorithm = random_() % 2 == 0 ? algorithm_kind::continuous : algorithm_kind::park2016;
        o.render = levels_;
        o.timeout_s = 0.05;
        live_.push_back(r_.begin_live(row(), o));
    }

    void feed_live(std::size_t i)
    {
        live_stroke::impl& l = *live_[i];
        if (random_() % 8 == 0)
            l.to({static_cast<double>(random_() % 25) - 2.0, static_cast<double>(random_() % 25) - 2.0},
                 static_cast<double>(random_() % 3) / 2.0);
        if (random_() % 3000 == 0)
            l.voice.request(engine::live_voice::action::end);
        if (random_() % 3000 == 0)
            l.voice.request(engine::live_voice::action::cancel);
        if (random_() % 64 == 0 && l.voice.closed()) {
            live_[i] = live_.back();
            live_.pop_back();
        }
    }

    void trouble()
    {
        switch (random_() % 8000) {
        case 0:
        case 1:
        case 2:
            r_.dac.advance(5000); // dry
            break;
        case 3:
            r_.dac.suspend();
            break;
        case 4:
            if (random_() % 6 == 0)
                r_.dac.disconnect();
            break;
        default:
            break;
        }
        if (random_() % 64 == 0)
            r_.dac.wake(random_() % 2 == 0);
    }

    void finish()
    {
        r_.stop();
        r_.dac.wake(true);
        for (int i = 0; i < 4000 && !r_.feed.stream_over(); ++i) {
            set_allowed();
            r_.play(period);
        }
        r_.control();
        REQUIRE(r_.feed.stream_over());
    }

    std::mt19937_64& random_;
    std::uint64_t most_periods_;
    render_options levels_{};
    double allowed_ = 0.0;
    checking_sink* sink_ = nullptr;
    rig r_;
    std::vector<std::shared_ptr<live_stroke::impl>> live_;
};

} // namespace

TEST_CASE(
    "a million periods with random faults: every stroke ends once, no sample jumps, none passes the limit")
{
    std::mt19937_64 random(seed);
    totals t;
    const std::uint64_t all_periods = soak_length("periods with faults", 1'000'000, 100'000);
    while (t.periods < all_periods) {
        CAPTURE(t.rigs);
        life(random, 5000 + random() % 60'000).run(t);
    }
    MESSAGE(t.periods << " periods on " << t.rigs << " devices, " << t.xruns << " xruns, " << t.strokes
                      << " strokes: " << t.states[state_kind::finished] << " finished, "
                      << t.states[state_kind::cancelled] << " cancelled, "
                      << t.states[state_kind::interrupted] << " interrupted");
    CHECK(t.states[state_kind::finished] > all_periods / 1000);
    CHECK(t.states[state_kind::cancelled] > all_periods / 10'000);
    CHECK(t.states[state_kind::interrupted] > all_periods / 10'000);
    CHECK(t.loudest > 0.05);
    CHECK(t.xruns > all_periods / 20'000);
}

} // namespace soak_faults_test
