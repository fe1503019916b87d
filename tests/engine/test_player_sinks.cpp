// SPDX-License-Identifier: MIT
// The player on PCMs and sinks without a clock, their wiring, and what it refuses.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/plan.hpp>
#include <tactor/player.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "clock_runner.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace player_sinks_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Returns options for the PCM called t of a configuration.
alsa_options configured(const std::string& text, format_kind f = format_kind::s32)
{
    alsa_options o = nine(f);
    o.pcm.assign(1, 't');
    o.config_text = text;
    return o;
}

std::size_t first_sound(const std::vector<std::byte>& all)
{
    return static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(), [](std::byte b) { return b != std::byte{0}; }) - all.begin());
}

stream_setup nine_channels()
{
    stream_setup s{.name = "memory", .channels = 9, .rate = rate};
    return s;
}

// Frames that a sink was given; outlives it.
struct taken {
    std::vector<std::byte> bytes = {};
    std::uint64_t frames = 0;
    std::size_t most = 0;
    bool gapless = true;
};

class memory_sink final : public paced_sink {
public:
    memory_sink(const stream_setup& s, taken& into, std::uint64_t ends_after = UINT64_MAX)
        : paced_sink(s), taken_(into), ends_after_(ends_after)
    {
    }

private:
    io_kind take(std::uint64_t first, std::span<const std::byte> data) noexcept override
    {
        const std::size_t frames = data.size() / setup().frame_bytes();
        if (first >= ends_after_)
            return io_kind::lost;
        taken_.gapless = taken_.gapless && first == taken_.frames;
        taken_.frames += frames;
        taken_.most = std::max(taken_.most, frames);
        taken_.bytes.insert(taken_.bytes.end(), data.begin(), data.end());
        return io_kind::ok;
    }

    taken& taken_;
    std::uint64_t ends_after_;
};

array line_of_three()
{
    return make_grid("line", 1, 3, 20.0, 20.0);
}

std::string lost(std::vector<std::vector<unsigned>> outputs)
{
    return lost_tactor(line_of_three(), {.outputs = std::move(outputs)});
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t earliest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t latest = std::numeric_limits<std::int64_t>::max();

// Returns palm() without its last tactors.
array first_of_palm(std::size_t tactors)
{
    array a = palm();
    a.tactors.resize(tactors);
    return a;
}

// Returns palm() with a lower limit on one tactor.
array palm_with_limit(std::size_t tactor, double max_dbfs)
{
    array a = palm();
    a.tactors[tactor].max_dbfs = max_dbfs;
    return a;
}

render_options on_nine_channels(double level_dbfs = -12.0)
{
    render_options o{.level_dbfs = level_dbfs, .channels = 9};
    return o;
}

score short_continuous()
{
    stroke s = preset_stroke("park2016-1");
    s.motion = s.motion.with_duration(0.2);
    return {palm(), make_continuous(s), on_nine_channels()};
}

// Returns the error of a player with this array for a score; "" where it plays it to its end.
std::string complaint(const array& a, const score& s)
{
    clocked_player p(patient(), {}, a);
    try {
        CHECK(p.wait(p.submit(s))->state == state_kind::finished);
        return "";
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
}

// Returns the field that a player of nine channels at 48 kHz refuses.
std::string refused_field(const score& s)
{
    clocked_player p;
    return caught_field([&] { p.submit(s); });
}

} // namespace

TEST_CASE("a file PCM receives silence, the renderer's bytes without a gap, silence")
{
    for (const format_kind f : {format_kind::s32, format_kind::s16}) {
        CAPTURE(to_string(f));
        const folder dir;
        const alsa_options o = configured(
            fmt::format("pcm.n {{ type null }} pcm.t {{ type file slave.pcm n file \"{}\" format raw }}",
                        (dir / "out.raw").string()),
            f);
        const score a = random_score(5, 6);
        const score b = random_score(6, 2);
        {
            player p(open_alsa(o), palm(), patient());
            CHECK_FALSE(p.setup().has_clock);
            const stroke_id id = p.submit(a);
            REQUIRE(p.wait(id));
            CHECK(p.wait(p.submit(b))->state == state_kind::finished);
            p.stop();
            CHECK(p.stats().xruns == 0);
        }
        const std::size_t frame = 9 * sample_bytes(f);
        const std::string raw = dir.bytes("out.raw");
        const auto written = std::as_bytes(std::span(raw));
        std::vector<std::byte> all(written.begin(), written.end());
        CHECK(all.size() % frame == 0);
        for (const score& s : {a, b}) {
            const std::vector<std::byte> want = rendered(s, f);
            // The renderer's first frame is the zero of a sine.
            const std::size_t from = first_sound(all) / frame * frame - first_sound(want) / frame * frame;
            REQUIRE(from + want.size() <= all.size());
            CHECK(part(all, from, want.size()) == want);
            all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(from + want.size()));
        }
        CHECK(first_sound(all) == all.size());
    }
}

TEST_CASE("a file that cannot be written ends the stream with the reason")
{
    player p(open_alsa(configured(
                 "pcm.n { type null } pcm.t { type file slave.pcm n file \"/dev/full\" format raw }")),
             palm());
    CHECK(play_to_failure(p, tone(60.0)).find("the device failed: Input/output error") != std::string::npos);
}

TEST_CASE("a stream with fewer channels than the array is refused with the tactor that would be mute")
{
    const array palm = preset_array("palm-3x3");
    CHECK(
        caught_message([&] { player(open_alsa({.pcm = "null", .channels = 4}), palm); }) ==
        "player: tactor 4 of palm-3x3 is on channel 4, but the stream has 4 channels (open the stream with 9 "
        "channels or more: they count from 0)");
    CHECK_NOTHROW(player(open_alsa({.pcm = "null", .channels = 9}), palm));
    CHECK_NOTHROW(player(open_alsa({.pcm = "null", .channels = 16}), palm));
}

TEST_CASE("an array that no file may have is refused by the player, too: its limits must count")
{
    std::vector<array> bad(4, preset_array("palm-3x3"));
    bad[0].tactors[3].channel = 4; // the limit of another tactor would count
    bad[1].tactors[0].max_dbfs = std::nan("");
    bad[2].tactors[0].max_dbfs = 20.0;
    bad[3].tactors.clear();
    for (const array& a : bad)
        CHECK_FALSE(caught_message([&] { player(open_alsa({.pcm = "null", .channels = 9}), a); }).empty());
}

TEST_CASE("a program's sink gets each frame once, at most a period at a time, with the renderer's bytes")
{
    taken t;
    const score s = random_score(4, 3);
    {
        player p(std::make_unique<memory_sink>(nine_channels(), t), palm(), patient());
        CHECK(p.setup().period_frames == 96);
        CHECK(p.setup().buffer_frames == 288);
        CHECK_FALSE(p.setup().has_clock);
        REQUIRE(p.wait(p.submit(s))->state == state_kind::finished);
    }
    CHECK(t.gapless);
    CHECK(t.most == 96);
    const auto expected = rendered(s, format_kind::s32);
    // The stroke's first frame is silent: look for its first sound.
    const std::size_t from = first_sound(t.bytes) - first_sound(expected);
    CHECK(part(t.bytes, from, expected.size()) == expected);
}

TEST_CASE("a program's sink that is lost ends the stream and the stroke")
{
    taken t;
    player p(std::make_unique<memory_sink>(nine_channels(), t, 4800), palm(), patient());
    try {
        CHECK(p.wait(p.submit(tone(10.0)))->state == state_kind::interrupted);
    } catch (const error& e) { // on a busy machine the stream is over before the stroke comes
        CHECK(e.kind() == error_kind::runtime);
    }
    while (!p.ended()) // a stroke ends before its stream
        std::this_thread::yield();
    CHECK(t.frames == 4800);
}

TEST_CASE("a program's sink refuses impossible numbers")
{
    taken t;
    const auto with = [&](auto change) {
        stream_setup s = nine_channels();
        change(s);
        CHECK_THROWS_AS(memory_sink(s, t), error);
    };
    with([](stream_setup& s) { s.channels = 0; });
    with([](stream_setup& s) { s.rate = 0; });
    with([](stream_setup& s) { s.rate = 4'000'000'000; });
    with([](stream_setup& s) { s.period_frames = 4'000'000'000; });
    with([](stream_setup& s) { s.period_frames = 2; }); // 42 us
    with([](stream_setup& s) { s.period_frames = 100, s.buffer_frames = 199; });
}

TEST_CASE("a tactor is lost when its channel reaches nothing, or nothing by itself")
{
    CHECK(lost({}).empty());
    CHECK(lost({{2}, {0}, {1}}).empty());
    CHECK(lost({{0, 3}, {1}, {2, 4}}).empty());
    CHECK(lost({{0, 1}, {1, 2}, {2, 3}}) ==
          "tactor 1 of line is on channel 1, which the PCM mixes with channel 0 of tactor 0");
    CHECK(lost({{0}, {}, {2}}) == "tactor 1 of line is on channel 1, which reaches no channel of the device");
    CHECK(lost({{5}, {1}, {5}}) ==
          "tactor 0 of line is on channel 0, which the PCM mixes with channel 2 of tactor 2");
    CHECK(lost({{0}, {1}}) == "tactor 2 of line is on channel 2, which reaches no channel of the device");
    // Channels without a tactor may share.
    CHECK(lost({{0}, {1}, {2}, {2}, {}}).empty());
    CHECK(lost_tactor(line_of_three(), {.hidden_by = "type pulse"}).empty());
}

TEST_CASE("a tactor that arrives louder is refused, other changes are warned of")
{
    stream_wiring w{.outputs = {{0}, {1}, {2, 3}}, .gains = {{1.0}, {-0.5}, {1.0, 0.1}}};
    CHECK(lost_tactor(line_of_three(), w).empty());
    CHECK(wiring_warnings(line_of_three(), w) ==
          std::vector<std::string>{
              "tactor 1 of line is on channel 1, which ALSA's configuration plays at -6.02 dB with its "
              "polarity reversed",
              "tactor 2 of line is on channel 2, which reaches 2 channels of the device, at 0 dB, -20 dB"});
    w.gains[1] = {-2.0};
    CHECK(lost_tactor(line_of_three(), w) ==
          "tactor 1 of line is on channel 1, which ALSA's configuration plays at 6.02 dB with its polarity "
          "reversed: louder than its limit allows");
    CHECK(wiring_warnings(line_of_three(), {}).empty());
    CHECK(wiring_warnings(line_of_three(), {.most_gain = 2.0}) ==
          std::vector<std::string>{"ALSA's configuration amplifies samples by up to 6.02 dB on the way to "
                                   "the device, and clips them there at full scale"});
    CHECK(wiring_warnings(line_of_three(), {.level_by = "type softvol"}) ==
          std::vector<std::string>{
              "a mixer control sets the level of all tactors: type softvol is between player and device"});
}

TEST_CASE("a player refuses an array of which a tactor is lost")
{
    alsa_options o{.pcm = "t",
                   .channels = 3,
                   .config_text = "pcm.n { type null }\n"
                                  "pcm.t { type route slave.pcm n ttable { 0.0 1 2.1 1 } }"};
    CHECK_THROWS_WITH_AS(
        player(open_alsa(o), line_of_three()),
        "stream on \"t\": tactor 1 of line is on channel 1, which reaches no channel of the "
        "device (in the PCM's ttable or bindings, route each channel to its own channel of the device with "
        "coefficient 1, or use device = hw:CARD=NAME to play on the card itself)",
        error);
    array two = line_of_three();
    two.tactors.erase(two.tactors.begin() + 1);
    CHECK_NOTHROW(player(open_alsa(o), two));
}

TEST_CASE("wiring that hides the channels' routes is logged, and plays")
{
    std::string said;
    alsa_options o{.pcm = "t",
                   .channels = 3,
                   .config_text = "pcm.n { type null }\n"
                                  "pcm.t { type route slave.pcm n ttable { 0.FL 1 } }"};
    o.log = [&](log_kind k, std::string_view text) {
        if (k == log_kind::warning)
            said += text;
    };
    CHECK_NOTHROW(player(open_alsa(o), line_of_three()));
    CHECK(said == "PCM \"t\": it is unknown which channels of the device its own reach: type route to a "
                  "channel FL is between");
}

TEST_CASE("a negative frame is an error with a hint")
{
    CHECK_THROWS_WITH_AS(start_at::frame(-1),
                         doctest::Contains("start: frame -1 is before the stream (give 0 or more"), error);
    CHECK_THROWS_AS(start_at::frame(earliest), error);
}

TEST_CASE("a time before all times plays now and reports how late; one after all times waits")
{
    rig r;
    r.play(48'000);
    REQUIRE(r.link.clock.load().valid());
    const stroke_id early = r.submit(tone(0.01), start_at::time(rt::to_time(earliest)));
    const stroke_id fired = r.submit(tone(0.01), start_at::trigger());
    CHECK(r.feed.fire(earliest) == 1);
    r.play_out();
    for (const stroke_id id : {early, fired}) {
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).late_s > 9e9);
    }
    const stroke_id late = r.submit(tone(0.01), start_at::time(rt::to_time(latest)));
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

TEST_CASE("the longest wait has no end, the shortest does not wait")
{
    clocked_player p;
    const stroke_id id = p.submit(tone(0.1));
    CHECK(p.wait(id, std::chrono::duration<double>(std::numeric_limits<double>::infinity())));
    const stroke_id other = p.submit(tone(0.1), start_at::trigger());
    CHECK_FALSE(p.wait(other, -std::chrono::duration<double>(std::numeric_limits<double>::infinity())));
    p.stop();
}

TEST_CASE("impossible options of the player are errors that name their field")
{
    const auto refused = [&](const player_options& o, player_lines lines = {}) {
        fake_dac dac;
        const std::string field = caught_field([&] {
            const running_clock clock(dac);
            const player p(alsa::adopt(dac.pcm(), nine()), palm(), o, std::move(lines));
        });
        CHECK(dac.closed());
        return field;
    };
    for (const double bad : {nan, infinity, -infinity, -1.0, -0.001, 1e9, 1e308}) {
        CAPTURE(bad);
        for (const auto& [field, name] :
             {std::pair(&player_options::horizon_s, "horizon_s"),
              std::pair(&player_options::fade_s, "fade_s"), std::pair(&player_options::stall_s, "stall_s")}) {
            player_options o = patient();
            o.*field = bad;
            CHECK(refused(o) == name);
        }
        for (const auto& [field, name] :
             {std::pair(&player_lines::settle_s, "settle_s"), std::pair(&player_lines::pulse_s, "pulse_s"),
              std::pair(&player_lines::trigger_delay_s, "trigger_delay_s")}) {
            player_lines lines;
            lines.*field = bad;
            CHECK(refused(patient(), std::move(lines)) == name);
        }
    }
    for (const auto& [field, name] : {std::pair(&drive_limits::power_dbfs, "power_dbfs"),
                                      std::pair(&drive_limits::max_drive_s, "max_drive_s"),
                                      std::pair(&drive_limits::window_s, "window_s")}) {
        player_options o = patient();
        o.limits.*field = nan;
        CHECK(refused(o) == name);
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

TEST_CASE("a score of another rate or of other channels than the stream's is refused by the one that differs")
{
    const auto with = [](unsigned channels, unsigned rate) {
        render_options o = on_nine_channels();
        o.channels = channels;
        o.rate = rate;
        return refused_field(tone(0.01, 0, o));
    };
    CHECK(with(9, 44100) == "rate");
    CHECK(with(10, 48000) == "channels");
    CHECK(with(10, 44100).empty());
}

TEST_CASE("a score that drives a channel without a tactor is refused, others play")
{
    const array few = first_of_palm(4);
    CHECK(complaint(few, tone(0.01, 3, on_nine_channels())).empty());
    CHECK(complaint(few, tone(0.01, 4, on_nine_channels())) ==
          "stroke: it drives tactor 4 on channel 4, but the player's array has no tactor there (plan the "
          "stroke for the player's array)");
    CHECK(complaint(few, tone(0.01, 4, on_nine_channels(), 0.0)).empty());
    has(complaint(few, random_score(1, 20, 9)), "but the player's array has no tactor there");
}

TEST_CASE("a continuous stroke counts every tactor of its array as driven")
{
    CHECK(complaint(palm(), short_continuous()).empty());
    has(complaint(first_of_palm(8), short_continuous()), "it drives tactor 8 on channel 8, but");
}

TEST_CASE("a score that drives a tactor above the player's limit is refused, with both levels")
{
    const array careful = palm_with_limit(2, -30.0);
    CHECK(complaint(careful, tone(0.01, 2, on_nine_channels())) ==
          "stroke: it drives tactor 2 at up to -12 dBFS, but the player's array allows -30 dBFS on channel 2 "
          "(plan the stroke for the player's array)");
    CHECK(complaint(careful, tone(0.01, 1, on_nine_channels())).empty());
    CHECK(complaint(careful, tone(0.01, 2, on_nine_channels(-30.0))).empty());
    has(complaint(careful, tone(0.01, 2, on_nine_channels(-29.9))), "at up to -29.9 dBFS");
    has(complaint(careful, short_continuous()), "at up to -12 dBFS");
}

TEST_CASE("a score planned within the same limits plays, whatever its peaks are known to be")
{
    // The bound on two continuous strokes at once is above their limit, since both may be at one place.
    array a = palm();
    for (tactor_spec& t : a.tactors)
        t.max_dbfs = -12.0;
    const auto across = [](double y) {
        return make_continuous({.motion = trajectory::timed({{0.0, {0.0, y}}, {0.1, {40.0, y}}})});
    };
    const score two(a, {{across(0.0), 0.0, {}}, {across(40.0), 0.0, {}}}, on_nine_channels());
    CHECK(complaint(a, two).empty());
    has(complaint(palm_with_limit(0, -20.0), two), "but the player's array allows -20 dBFS on channel 0");
}

TEST_CASE("a marker on a tactor's channel is refused, on a spare channel it plays")
{
    render_options o = on_nine_channels();
    o.marker_channel = 8;
    const array eight = first_of_palm(8);
    const score s(eight, make_plan(eight, preset_stroke("park2016-1")), o);
    CHECK(complaint(eight, s).empty());
    CHECK(complaint(palm(), s) == "stroke: its marker is on channel 8, but the player's array has a tactor "
                                  "there (choose a spare channel for the marker)");
    CHECK(refused_field(s) == "marker_channel");
}

} // namespace player_sinks_test
