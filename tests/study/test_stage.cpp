// SPDX-License-Identifier: MIT
// Stimuli on devices whose clock the test has: frames, and what makes a trial void.
#include "study/session/stage.hpp"

#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"
#include "stage_support.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/experiment/trials.hpp"

namespace stage_test {

TEST_CASE("both stimuli of a pair are at their reported frames, the gap between them exact to the frame")
{
    set_up s;
    const auto d = study::read_definition(pairs, "pairs.toml", {});
    render_options o{.rate = rate, .level_dbfs = *d.level_dbfs};
    const study::stimulus_set stimuli(d, palm(), o);
    const auto gap = static_cast<std::size_t>(std::llround(0.0321 * rate));
    for (const study::planned_trial t : {study::planned_trial{0, 0, 1}, study::planned_trial{0, 1, 0}}) {
        const study::given_stimulus g = s.there.play_score(stimuli.make_score(t), lead_s, nobody);
        REQUIRE(g.flaw.empty());
        REQUIRE(g.first_frame);
        CHECK(g.xruns == 0);
        const study::stimulus& first = stimuli.at(0, t.method_1);
        const study::stimulus& second = stimuli.at(0, *t.method_2);
        CHECK(g.frames == first.frames + gap + second.frames);
        CHECK(stimuli.starts(t)[1] == first.frames + gap);
        const std::vector<std::byte> all = s.dac.captured();
        const auto piece = [&](std::size_t from, std::size_t n) {
            return part(all, from * frame, n * frame);
        };
        const auto alone = [&](const study::stimulus& x) {
            return rendered(score(palm(), x.made.plans, x.render), format_kind::s32);
        };
        CHECK(piece(*g.first_frame, first.frames) == alone(first));
        CHECK_FALSE(sounds(piece(*g.first_frame + first.frames, gap)));
        CHECK(piece(*g.first_frame + stimuli.starts(t)[1], second.frames) == alone(second));
        CHECK_FALSE(sounds(piece(*g.first_frame - rate / 10, rate / 10))); // the lead
    }
    s.there.finish();
}

TEST_CASE("a reported frame is right even without time for it")
{
    set_up s;
    const score music = random_score(3, 4);
    for (int i = 0; i < 5; ++i) {
        const study::given_stimulus g = s.there.play_score(music, 0.0, nobody);
        REQUIRE(g.flaw.empty());
        REQUIRE(g.first_frame);
        CHECK(part(s.dac.captured(), *g.first_frame * frame, music.frames() * frame) ==
              rendered(music, format_kind::s32));
    }
    s.there.finish();
}

TEST_CASE("an xrun makes it void, and the next is whole again")
{
    set_up s;
    {
        const meanwhile x(s, [&] { s.dac.advance(1'000'000); });
        const study::given_stimulus g = s.there.play_score(tone(0.5), lead_s, nobody);
        CHECK_FALSE(g.flaw.empty());
        CHECK(g.xruns == 1);
        REQUIRE(g.first_frame);
        CHECK(g.frames > 0);
        CHECK(g.frames < rate / 2);
    }
    CHECK_FALSE(s.there.lost());
    const study::given_stimulus next = s.there.play_score(tone(0.1), lead_s, nobody);
    CHECK(next.flaw.empty());
    CHECK(next.xruns == 0);
    s.there.finish();
}

TEST_CASE("a device that is lost makes it void, in the stimulus and while time passes")
{
    set_up s;
    {
        const meanwhile x(s, [&] { s.dac.disconnect(); });
        const study::given_stimulus g = s.there.play_score(tone(0.5), lead_s, nobody);
        CHECK(g.flaw == "the device is gone");
    }
    while (!s.there.lost())
        std::this_thread::yield();
    CHECK_FALSE(s.there.wait_for_seconds(1.0, [](double) { return true; }));
    CHECK(s.there.play_score(tone(0.1), lead_s, nobody).flaw == "the device is gone");
    s.there.finish();
}

TEST_CASE("a stimulus that a limit changed says so")
{
    set_up s(0.3); // for so long one tactor may be driven in ten seconds
    CHECK_FALSE(s.there.play_score(tone(0.1), 0.0, nobody).limited);
    const study::given_stimulus g = s.there.play_score(tone(0.5), 0.0, nobody);
    CHECK(g.flaw.empty());
    CHECK(g.limited);
    s.there.finish();
    set_up quiet(5.0, 10.0, -20.0); // of all tactors together, below the usual -12 dBFS of one
    CHECK_FALSE(quiet.there.play_score(tone(0.1, 0, {.level_dbfs = -30.0}), 0.0, nobody).limited);
    CHECK(quiet.there.play_score(tone(0.1), 0.0, nobody).limited);
    quiet.there.finish();
}

TEST_CASE("a stimulus that falls silent because of those before says so")
{
    set_up s(0.3, 3600.0); // an hour, on a DAC that does not wait for the test
    CHECK_FALSE(s.there.play_score(tone(0.25), 0.0, nobody).limited);
    // Its tactor is closed in the midst of this one, and still for the next.
    CHECK(s.there.play_score(tone(0.2), 0.0, nobody).limited);
    CHECK(s.there.play_score(tone(0.2), 0.0, nobody).limited);
    CHECK(s.there.play_score(tone(0.01), 0.0, nobody).limited);
    CHECK_FALSE(s.there.play_score(tone(0.2, 4), 0.0, nobody).limited);
    CHECK(s.there.wait_for_room(tone(0.2), 0.1, [](double) { return false; })); // somebody ends it
    CHECK(s.there.play_score(tone(0.2), 0.1, nobody).limited);
    s.there.finish();
}

TEST_CASE("after a stimulus that a limit cut, the next one waits until it is whole")
{
    set_up s(0.3, 60.0);
    CHECK(s.there.play_score(tone(0.5), 0.0, nobody).limited);
    CHECK(s.there.wait_for_room(tone(0.05), 0.1, [](double) { return true; }));
    CHECK_FALSE(s.there.play_score(tone(0.05), 0.1, nobody).limited);
    s.there.finish();
}

TEST_CASE("a stimulus that has waited for room is whole")
{
    set_up s(0.3, 60.0);
    for (int i = 0; i < 4; ++i) {
        CHECK(s.there.wait_for_room(tone(0.25), 0.1, [](double) { return true; }));
        const study::given_stimulus g = s.there.play_score(tone(0.25), 0.1, nobody);
        CHECK(g.flaw.empty());
        CHECK_FALSE(g.limited);
    }
    s.there.finish();
}

TEST_CASE("a tactor that has rested before its device was lost needs no rest when it is back")
{
    std::vector<std::unique_ptr<fake_dac>> cards;
    std::unique_ptr<running_clock> clock;
    session::stream_options o;
    o.reopen_s = 3600.0;
    const environment where = nine_tactors(0.3, 6.0);
    study::stage there(nine(), o, where, [&](session::stream_parts& p) {
        p.open = [&] {
            clock.reset();
            cards.push_back(std::make_unique<fake_dac>());
            auto card = alsa::adopt(cards.back()->pcm(), nine());
            clock = std::make_unique<running_clock>(*cards.back());
            return card;
        };
        p.player = patient(p.player.limits);
        p.player.realtime = false;
        p.times.retry_s = p.times.proof_s = 0.001;
    });
    const auto waits = [&](double seconds) {
        bool waited = false;
        CHECK(there.wait_for_room(tone(seconds), lead_s, [&](double) { return waited = true; }));
        return waited;
    };
    CHECK_FALSE(there.play_score(tone(0.25), lead_s, nobody).limited);
    CHECK(waits(0.25));
    CHECK(there.wait_for_seconds(6.0, [](double) { return true; }));
    CHECK_FALSE(waits(0.25));
    cards.back()->disconnect();
    while (!there.lost())
        std::this_thread::yield();
    REQUIRE(there.reopen());
    CHECK(cards.size() == 2);
    CHECK_FALSE(waits(0.25));
    there.finish();
    clock.reset();
}

TEST_CASE("a tactor of the walk that a limit silenced is driven again when it has rested")
{
    set_up s(0.3, 60.0);
    CHECK_FALSE(s.there.play_score(tone(0.25), 0.0, nobody).limited);
    bool waited = false;
    const study::given_stimulus g = s.there.play_with_retry(tone(0.2), [&](double) { return waited = true; });
    CHECK(g.fault().empty());
    CHECK(waited);
    // Nobody waits where no limit acts.
    CHECK(s.there.play_with_retry(tone(0.05), [&](double) -> bool { throw 1; }).fault().empty());
    s.there.finish();
}

TEST_CASE("what the experimenter cuts off says so")
{
    set_up s;
    const study::given_stimulus g =
        s.there.play_score(tone(100'000.0), 0.0, [&](std::uint64_t) { s.there.cancel(); });
    CHECK(g.flaw == "it was cut off");
    s.there.finish();
}

TEST_CASE("time passes by the stream alone")
{
    set_up s;
    const std::uint64_t before = s.there.position().played;
    double last = -1.0;
    CHECK(s.there.wait_for_seconds(0.5, [&](double t) {
        CHECK(t >= last);
        CHECK(t < 0.5);
        last = t;
        return true;
    }));
    CHECK(s.there.position().played >= before + rate / 2);
    CHECK(s.there.wait_for_seconds(1e9, [](double) { return false; })); // somebody ends it
    s.there.finish();
}

TEST_CASE("noise that stands still makes it void; noise whose device is gone is opened again")
{
    std::vector<std::unique_ptr<fake_dac>> headphones;
    std::vector<std::unique_ptr<running_clock>> clocks;
    set_up s;
    const auto open = [&] {
        headphones.push_back(std::make_unique<fake_dac>());
        fake_dac& d = *headphones.back();
        auto sink = alsa::adopt(d.pcm(), {.channels = 2, .period_frames = 480, .periods = 4});
        clocks.push_back(std::make_unique<running_clock>(d, running_clock::capture_kind::kept));
        return sink;
    };
    s.there.set_masking(open, {.level_dbfs = -20.0, .patience_s = 600.0});
    const auto give = [&] {
        const study::noise_around noise(s.there);
        return s.there.play_score(tone(0.5), lead_s, nobody);
    };
    CHECK(give().flaw.empty());
    CHECK(sounds(headphones[0]->captured()));
    {
        const meanwhile x(s, [&] {
            fake_dac& d = *headphones[0];
            d.advance(1'000'000);
            d.await([&] { return d.starts() == 2; });
            const std::size_t again = d.captured_frames();
            d.await([&] { return d.captured_frames() > again + 4800; });
        });
        CHECK(give().flaw == "the masking noise stopped");
    }
    {
        const meanwhile x(s, [&] {
            headphones[0]->disconnect();
            while (s.there.noise_end_reason() == io_kind::ok)
                std::this_thread::yield();
        });
        CHECK_FALSE(give().flaw.empty());
    }
    CHECK(headphones.size() == 1);
    CHECK(give().flaw.empty());
    CHECK(headphones.size() == 2);
    s.there.finish();
    clocks.clear();
}

} // namespace stage_test
