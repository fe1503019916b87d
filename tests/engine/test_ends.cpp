// SPDX-License-Identifier: MIT
// Ends of strokes: by themselves, cancelled, stopped, in any order with faults.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <poll.h>

#include "has.hpp"
#include "rig.hpp"

namespace ends_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Runs only the DAC and the audio thread.
void sleep_of_control(rig& r, int periods)
{
    for (int i = 0; i < periods; ++i) {
        r.dac.advance_queued(r.options.period);
        r.step();
    }
}

/// Returns options without an amplifier driver: strokes wait until the test sets it ready.
rig_options held()
{
    rig_options o;
    o.loop.amplifier = true;
    return o;
}

state_kind unheard_state(const rig& r, stroke_id id)
{
    CHECK(r.end(id).frames == 0);
    return r.end(id).state;
}

} // namespace

TEST_CASE("a stroke is not finished before its last frame has reached the DAC")
{
    rig r;
    const score s = tone(0.01);
    const std::uint64_t end = r.status().written + s.frames();
    const stroke_id id = r.submit(s);
    while (r.status().played < end) {
        CHECK(r.ended.empty());
        r.play(96);
        REQUIRE_FALSE(r.loop.over());
    }
    CHECK(ending(r.end(id)) == "finished");
    CHECK(r.end(id).frames == s.frames());
}

TEST_CASE("a cancelled stroke fades and is then reported once, with the frames that it got")
{
    rig r;
    const std::uint64_t from = r.status().written;
    const stroke_id id = r.submit(tone(10.0));
    r.play(9600);
    const std::uint64_t fade_from = r.status().written;
    CHECK_FALSE(r.feed.cancel({id.number + 1}));
    CHECK(r.feed.cancel(id));
    CHECK_FALSE(r.feed.cancel(id));
    r.play(9600);
    CHECK(r.end(id).state == state_kind::cancelled);
    CHECK(r.end(id).frames == fade_from + 480 - from);
    CHECK_FALSE(r.first_sound(fade_from + 480));
    CHECK(r.first_sound(fade_from + 470));
    // A 250 Hz sine of -12 dBFS moves by at most 0.0083 a frame; a fade of 10 ms adds little.
    const double tone_step = 0.2512 * 2 * 3.14159265 * 250 / rate;
    CHECK(largest_step(r.channel(0, from)) < tone_step * 1.1);
    CHECK_FALSE(r.feed.cancel(id));
    CHECK(r.feed.reports().empty());
}

TEST_CASE("a cancel before, in, and after the hand-over ends a stroke once and without a sound")
{
    for (const std::uint64_t ahead : {std::uint64_t{1'000'000}, std::uint64_t{10'000}, std::uint64_t{0}}) {
        CAPTURE(ahead);
        rig r;
        const stroke_id id = r.submit(tone(0.5), ahead == 0 ? 0 : r.status().written + ahead);
        if (ahead == 10'000)
            r.play(960);
        CHECK(r.feed.cancel(id));
        r.play(20'000);
        CHECK(r.end(id).state == state_kind::cancelled);
        CHECK(r.end(id).frames == 0);
        CHECK_FALSE(r.first_sound());
        CHECK(r.feed.stream_over() == false);
    }
}

TEST_CASE(
    "a stroke's level is what sounds within two periods and 20 ms, from its first frame if it was given")
{
    rig r({.format = format_kind::s32});
    const auto level = [&](std::uint64_t first, std::uint64_t frames) {
        return peak(r.channel(0, first), 0, frames);
    };
    const std::uint64_t from = r.status().written;
    const stroke_id id = r.submit(tone(10.0)); // -12 dBFS
    r.play(9600);
    const std::uint64_t asked = r.status().written;
    CHECK(r.feed.set_gain(id, 0.1F));
    r.play(9600);
    const std::uint64_t quiet = asked + 2 * r.options.period + 960;
    CHECK(level(quiet, 4800) == doctest::Approx(0.02512).epsilon(0.01));
    CHECK(largest_step(r.channel(0, from)) < 0.2512 * 2 * 3.14159265 * 250 / rate * 1.1);
    CHECK(r.feed.set_gain(id, 1.0F));
    r.play(9600);
    CHECK(level(r.status().played - 4800, 4000) == doctest::Approx(0.2512).epsilon(0.01));
    const stroke_id later = r.submit(tone(0.2), r.status().written + 9600);
    CHECK(r.feed.set_gain(later, 0.5F));
    CHECK(r.feed.cancel(id));
    r.play(4800);
    const std::uint64_t second = r.status().written;
    r.play_out();
    CHECK(level(second, 9600) == doctest::Approx(0.1256).epsilon(0.01));
    CHECK(r.end(later).state == state_kind::finished);
    CHECK_FALSE(r.feed.set_gain(later, 0.5F));
}

TEST_CASE("a stroke whose level is given before it begins has no loud onset")
{
    const auto level = [](rig& r, std::uint64_t from) {
        r.play_out();
        return doctest::Approx(peak(r.channel(0, from))).epsilon(0.01);
    };
    constexpr double asked = 0.02512;                                // a tenth of -12 dBFS
    for (const std::uint64_t wait : {0U, 1U, 96U, 200U, 100'000U}) { // the last beyond the horizon
        CAPTURE(wait);
        rig r({.format = format_kind::s32});
        const std::uint64_t from = r.status().written;
        const stroke_id id = wait == 0 ? r.submit(tone(0.1)) : r.submit(tone(0.1), from + wait);
        CHECK(r.feed.set_gain(id, 0.1F));
        CHECK(asked == level(r, from));
    }
    rig armed;
    const std::uint64_t from = armed.status().written;
    armed.feed.submit(armed.next_id(), tone(0.1), start_at::trigger(), 0.1F);
    armed.play(960);
    CHECK(armed.feed.fire(armed.now) == 1);
    CHECK(asked == level(armed, from));
    rig broken;
    const stroke_id later = broken.submit(tone(0.1), broken.status().written + 9600);
    CHECK(broken.feed.set_gain(later, 0.1F));
    broken.play(960);
    broken.xrun(); // which gives it another ticket
    CHECK(asked == level(broken, broken.status().written));
}

TEST_CASE("stop fades all sound, waits until it is out, and drops the stream")
{
    for (const bool closing : {false, true}) {
        CAPTURE(closing);
        rig r;
        const stroke_id sounding = r.submit(tone(5.0));
        const stroke_id later = r.submit(tone(5.0), r.status().written + 12'000);
        const stroke_id far = r.submit(tone(5.0), r.status().written + 10 * rate);
        r.play(4800);
        const std::uint64_t next = r.status().written;
        r.stop(closing);
        r.play(48'000);
        CHECK(r.loop.over());
        CHECK_FALSE(r.dac.running());
        CHECK(r.feed.stream_over());
        for (const stroke_id id : {sounding, later, far}) {
            CHECK(ending(r.end(id)) ==
                  (closing ? "interrupted, closed: the player was closed" : "cancelled"));
            CHECK((r.end(id).frames > 0) == (id == sounding));
        }
        CHECK_FALSE(r.first_sound(next + 480));
        // The fade and a period of silence left the buffer before the drop.
        CHECK(r.dac.captured_frames() >= next + 480 + 96);
        CHECK(r.dac.captured_frames() <= next + 480 + 96 * 8);
    }
}

TEST_CASE("stop cuts a long buffer after 0.4 s")
{
    for (const bool closing : {false, true}) {
        CAPTURE(closing);
        rig r({.period = 480, .periods = 200});
        const stroke_id sounding = r.submit(tone(10.0));
        r.play(5 * rate);
        REQUIRE(r.status().running);
        r.stop(closing);
        r.play(rate / 10 * 4);
        CHECK_FALSE(r.loop.over());
        // Wakes by itself, however long a period is.
        CHECK(r.loop.timeout_ns() <= 20'000'000);
        r.play(960);
        CHECK(r.loop.over());
        CHECK_FALSE(r.dac.running());
        CHECK(ending(r.end(sounding)) ==
              (closing ? "interrupted, closed: the player was closed" : "cancelled"));
    }
}

TEST_CASE("after the cut nothing is mixed while the amplifier goes off, however many strokes could not fade")
{
    rig r({.period = 4800, .periods = 5});
    r.link.amplifier.off = false;
    for (int i = 0; i < 300; ++i) // more than can fade at once
        r.submit(tone(10.0));
    r.play(rate);
    r.stop();
    while (r.status().stage != engine::stream_stage::closing)
        r.step(); // the DAC stands still: no fade begins
    const std::uint64_t from = r.dac.captured_frames();
    REQUIRE(r.first_sound(from - 4800));
    r.play(rate / 2);
    CHECK(r.dac.captured_frames() > from);
    CHECK_FALSE(r.first_sound(from));
    r.link.amplifier.off = true;
    r.step();
    CHECK(r.loop.over());
}

TEST_CASE("of all strokes that are cancelled those that sound fade first, and each ends once")
{
    rig r;
    for (int i = 0; i < 1000; ++i) // more than the audio thread holds
        r.submit(tone(10.0), i % 2 == 0 ? start_at::frame(1'000'000'000) : start_at::trigger());
    r.play(4800);
    const stroke_id sounding = r.submit(tone(10.0));
    r.play(4800);
    const std::uint64_t next = r.status().written;
    r.feed.cancel_all(r.last());
    CHECK(r.link.requests.size() == 1);
    CHECK(r.feed.fire(r.now) == 0);
    const stroke_id after = r.submit(tone(0.01));
    r.play(4800);
    CHECK(r.end(after).state == state_kind::finished);
    for (const auto& [id, reports] : r.ended)
        CHECK((id == after || r.end(id).state == state_kind::cancelled));
    CHECK(r.ended.size() == 1002);
    CHECK(r.end(sounding).frames > 0);
    CHECK_FALSE(r.first_sound(next + 480 + 96));
    CHECK(r.status().running);
}

TEST_CASE("drives that come too late end the stroke instead of starting in mid-burst")
{
    rig r({.loop = {.horizon_frames = 2400}});
    const std::uint64_t from = r.status().written;
    const score s = random_score(31, 20);
    const stroke_id id = r.submit(s);
    sleep_of_control(r, 200); // much longer than its horizon
    has(ending(r.play_out(id)), "interrupted, late: the computer was too slow");
    // The part that sounded is a true beginning of the stroke.
    const std::uint64_t sure = 2400 - 480;
    const std::vector<std::byte> all = rendered(s, format_kind::s32);
    const std::vector<std::byte> got = r.captured(from, sure);
    CHECK(std::equal(got.begin(), got.end(), all.begin()));
    CHECK_FALSE(r.first_sound(from + 2400 + 4800 + 480));
}

TEST_CASE("a cancel ends a stroke whose drives never came, although its time is over")
{
    rig r({.loop = {.horizon_frames = 2400}});
    const score s = random_score(31, 20);
    const stroke_id id = r.submit(s);
    while (r.status().written < s.frames() + 9600)
        sleep_of_control(r, 1);
    CHECK(r.feed.cancel(id)); // before the control thread hands over its late drives
    r.play(4800);
    CHECK(r.end(id).state == state_kind::cancelled);
}

TEST_CASE("a continuous stroke whose drives stop coming fades before the last of them")
{
    stroke around = preset_stroke("park2016-3");
    around.sound.carrier_hz = 230.0;
    const score s(palm(), make_continuous(around));
    for (const std::uint32_t fade : {48U, 480U, 4800U}) {
        rig r({.loop = {.fade_frames = fade, .horizon_frames = 2400}});
        const std::uint64_t from = r.status().written;
        const stroke_id id = r.submit(s);
        r.play(9600);
        REQUIRE_FALSE(r.report(id));
        sleep_of_control(r, 100);
        has(ending(r.play_out(id)), "too slow");
        const std::uint64_t end = r.end(id).frames;
        CHECK(end > 9600);
        CHECK_FALSE(r.first_sound(from + end));
        const std::vector<std::byte> got = r.captured(from, end);
        const std::vector<std::byte> all = rendered(s, format_kind::s32);
        const std::size_t whole = (end - 192) * s.channels() * 4;
        CHECK(std::equal(got.begin(), got.begin() + static_cast<std::ptrdiff_t>(whole), all.begin()));
        // Its last frames are nearly silent.
        for (unsigned c = 0; c < s.channels(); ++c)
            CHECK(peak(r.channel(c, from + end - 6)) < 0.05 * 0.25);
    }
}

namespace {

/// Calls a function before it writes the first frames that sound.
class first_sound_sink final : public forwarding_sink {
public:
    first_sound_sink(std::unique_ptr<sink> s, const std::function<void()>& sounds)
        : forwarding_sink(std::move(s)), sounds_(sounds)
    {
    }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const auto heard = [](std::byte b) { return b != std::byte{0}; };
        if (!sounded_ && std::any_of(frames.begin(), frames.end(), heard)) {
            sounded_ = true;
            sounds_();
        }
        return forwarding_sink::write(frames);
    }

private:
    const std::function<void()>& sounds_;
    bool sounded_ = false;
};

} // namespace

TEST_CASE("the control thread is woken before the first sound, so that what may be driven is written first")
{
    std::function<void()> sounds;
    rig_options o;
    o.wrap = [&](std::unique_ptr<sink> s) {
        return std::make_unique<first_sound_sink>(std::move(s), sounds);
    };
    rig r(o);
    bool sounded = false;
    bool woken = false;
    sounds = [&] {
        pollfd fd{.fd = r.link.to_control.fd(), .events = POLLIN, .revents = 0};
        sounded = true;
        woken = ::poll(&fd, 1, 0) == 1;
    };
    r.submit(tone(0.1));
    for (int i = 0; i < 100 && !sounded; ++i) {
        r.link.to_control.consume();
        r.dac.advance_queued(r.options.period);
        r.step();
    }
    CHECK(sounded);
    CHECK(woken);
}

TEST_CASE("where two drives end together and no more come, the one that would go on is faded")
{
    constexpr engine::ticket score = engine::voices + 5;
    const auto drive = [](std::uint32_t channel, std::uint64_t window) {
        engine::command c{.what = engine::command::kind::drive, .score = score};
        c.drive.cycles_per_frame = 250.0 / rate;
        c.drive.window = window;
        c.drive.length = 4800;
        c.drive.score = score;
        c.drive.drives = 1;
        c.drive.drive[0] = {0.5, 0.5, channel};
        return c;
    };
    for (const bool open_first : {true, false}) {
        CAPTURE(open_first);
        rig r;
        r.link.commands.push(
            {.what = engine::command::kind::begin, .score = score, .id = {1}, .length = 9600});
        r.link.commands.push(drive(0, open_first ? 9600 : 4800));
        r.link.commands.push(drive(1, open_first ? 4800 : 9600));
        sleep_of_control(r, 100);
        std::vector<engine::report> reports(1);
        for (; r.link.reports.pop(reports.back()); reports.emplace_back()) {
        }
        reports.pop_back();
        REQUIRE(reports.size() == 2);
        CHECK(reports[1].state == state_kind::interrupted);
        CHECK(reports[1].why == reason_kind::late);
        const std::vector<double> x = r.channel(open_first ? 0 : 1);
        CHECK(peak(x) > 0.4);
        CHECK(largest_step(x) < 0.02); // 0.5 * 2 pi * 250 / 48000, and no end in full swing
    }
}

TEST_CASE("the display shows the newest stroke that sounds")
{
    rig r;
    CHECK(r.status().running);
    CHECK_FALSE(r.status().sounding);
    const std::uint64_t base = r.status().written;
    const stroke_id a = r.submit(tone(1.0));
    const stroke_id b = r.submit(tone(0.2), base + 9600);
    r.play(4800);
    CHECK(r.status().sounding);
    CHECK(r.status().stroke == a);
    CHECK(r.status().stroke_frame == r.status().played - base);
    r.play(9600);
    CHECK(r.status().stroke == b);
    CHECK(r.status().stroke_frame == r.status().played - base - 9600);
    r.play(9600);
    CHECK(r.status().stroke == a);
    r.play(48'000);
    CHECK_FALSE(r.status().sounding);
}

TEST_CASE("the display shows a stroke from its first frame to its last, at the DAC")
{
    rig r;
    const std::uint64_t at = r.status().written + 960;
    r.submit(tone(0.01), at);
    for (std::uint64_t played = 0; played < at + 960; played = r.status().played) {
        CAPTURE(played);
        CHECK(r.status().sounding == (played >= at && played < at + 480));
        r.play(96);
    }
}

TEST_CASE("before its first frame is mixed a stroke is cancelled without a sound, and outlasts a mute")
{
    for (const bool muted : {false, true}) {
        CAPTURE(muted);
        rig r;
        const std::uint64_t at = r.status().written + 960;
        const stroke_id id = r.submit(tone(0.1), at);
        while (r.status().written < at)
            r.play(96);
        REQUIRE(r.status().written == at); // the next frame is its first
        if (muted)
            r.link.amplifier.mutes = 1;
        else
            r.feed.cancel(id);
        CHECK(r.play_out(id).state == (muted ? state_kind::finished : state_kind::cancelled));
        CHECK((r.end(id).frames == 0) != muted);
        CHECK(r.first_sound().has_value() == muted);
    }
}

TEST_CASE("while the amplifier settles a cancel is reported with the next wake-up, and other strokes play")
{
    rig r(held());
    const score kept = random_score(3, 5);
    const stroke_id first = r.submit(tone(1.0));
    const stroke_id second = r.submit(kept);
    const stroke_id third = r.submit(tone(1.0));
    r.play(960);
    CHECK(r.ended.empty());
    CHECK(r.feed.cancel(first));
    CHECK(r.feed.cancel(third));
    CHECK_FALSE(r.feed.cancel(first));
    r.step(); // the DAC stands still
    r.control();
    CHECK(unheard_state(r, first) == state_kind::cancelled);
    CHECK(unheard_state(r, third) == state_kind::cancelled);
    CHECK_FALSE(r.report(second));

    const std::uint64_t from = r.status().written;
    r.link.amplifier.ready = true;
    CHECK(r.play_out(second).state == state_kind::finished);
    CHECK(r.captured(from, kept.frames()) == rendered(kept, format_kind::s32));
    CHECK(r.ended.size() == 3);
}

TEST_CASE("thousands of strokes submitted and cancelled while they wait end once each, unheard")
{
    rig r(held());
    constexpr unsigned rounds = 2000;
    for (unsigned n = 1; n <= rounds; ++n) {
        r.submit(tone(0.01, n % 9));
        if (n % 7 == 0)
            r.play(96);
        CHECK(r.feed.cancel({n}));
        if (n % 5 == 0)
            r.play(96);
    }
    r.play(960);
    CHECK(r.ended.size() == rounds);
    for (unsigned n = 1; n <= rounds; ++n)
        CHECK(unheard_state(r, {n}) == state_kind::cancelled);
    r.link.amplifier.ready = true;
    r.play(9600);
    CHECK_FALSE(r.first_sound());
    CHECK(r.ended.size() == rounds);
    CHECK(r.play_out(r.submit(tone(0.01))).state == state_kind::finished);
    CHECK(r.first_sound());
}

TEST_CASE("stop reaches strokes that wait for the amplifier")
{
    rig r(held());
    const stroke_id cancelled = r.submit(tone(1.0));
    const stroke_id stopped = r.submit(tone(1.0));
    CHECK(r.feed.cancel(cancelled));
    r.stop();
    r.step();
    r.control();
    CHECK(unheard_state(r, cancelled) == state_kind::cancelled);
    CHECK(unheard_state(r, stopped) == state_kind::cancelled);
    r.play(4 * 96 + 288);
    CHECK(r.loop.over());
}

TEST_CASE("live strokes behind a waiting stroke end, cancel and time out as without it")
{
    live_rig r({.timeout_s = 0.2}, held());
    const stroke_id before = r.submit(tone(0.1));
    const auto ended = r.add({.timeout_s = 0.2});
    const auto cancelled = r.add({.timeout_s = 0.2});
    const auto fed = r.add({.timeout_s = 0.2});
    r.play(960);
    ended->voice.request(engine::live_voice::action::end);
    cancelled->voice.request(engine::live_voice::action::cancel);
    r.play(192);
    CHECK(unheard_state(r, ended->id) == state_kind::finished);
    CHECK(unheard_state(r, cancelled->id) == state_kind::cancelled);
    for (int i = 0; i < 110; ++i) {
        fed->to({0.0, 0.0}, 1.0);
        r.play(96);
    }
    CHECK(r.end(r.live->id).frames == 0);
    CHECK(ending(r.end(r.live->id)) == "interrupted, starved: no more points came");
    CHECK_FALSE(r.report(before));
    CHECK_FALSE(r.report(fed->id));
    CHECK_FALSE(r.first_sound());
    r.link.amplifier.ready = true;
    r.play(960);
    CHECK(r.first_sound());
    CHECK(r.finish(*fed).state == state_kind::finished);
    CHECK(r.end(before).state == state_kind::finished);
}

TEST_CASE("while the system sleeps, a handle cancels a live stroke that waits")
{
    live_rig r;
    r.play(960);
    r.dac.suspend();
    r.step();
    r.control();
    REQUIRE(r.status().stage == engine::stream_stage::suspended);
    const stroke_id score = r.submit(tone(0.1));
    r.live->voice.request(engine::live_voice::action::cancel);
    CHECK(r.feed.cancel(score));
    r.step();
    r.control();
    CHECK(unheard_state(r, r.live->id) == state_kind::cancelled);
    CHECK(unheard_state(r, score) == state_kind::cancelled);
}

} // namespace ends_test
