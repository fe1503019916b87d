// SPDX-License-Identifier: MIT
// Set-up of a device: its answers to the request, and the resulting stream.
#include <string>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "device_says.hpp"
#include "fake_dac.hpp"
#include "has.hpp"
#include "sink/alsa/adopt.hpp"
#include "sink/alsa/handle.hpp"

namespace agreed_test {

using namespace tactor;
using test::device_answers;
using test::device_says;
using test::fake_dac;

namespace {

const alsa_options eight{.pcm = "card", .channels = 8};

struct agreement {
    stream_setup setup = {};
    std::string log = {};
};

agreement agreed(const device_answers& a, const test::fake_dac_options& d = {}, alsa_options o = eight)
{
    fake_dac dac(d);
    agreement made;
    o.log = [&](log_kind, std::string_view text) { made.log += std::string(text) + "\n"; };
    const device_says it(a);
    made.setup = alsa::adopt(dac.pcm(), o)->setup();
    return made;
}

bool within(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("a device whose position moves by whole periods is recognised, and the log says so")
{
    for (const bool batch : {false, true}) {
        CAPTURE(batch);
        const agreement a = agreed({.batch = batch});
        CHECK(a.setup.batch == batch);
        CHECK(within(a.log, "PCM \"card\": its position moves by whole periods") == batch);
    }
}

TEST_CASE("a device that changes the set values is refused")
{
    for (const device_answers& a :
         {device_answers{.channels = 7}, device_answers{.rate = 44100}, device_answers{.period_frames = 0},
          device_answers{.buffer_frames = 95}}) {
        try {
            agreed(a);
            FAIL("it was taken");
        } catch (const error& e) {
            CHECK(e.kind() == error_kind::not_available);
            has(e.what(), "asked for 8 channels at 48000 Hz in s32");
            has(e.what(), "it made ");
        }
    }
    CHECK(agreed({.buffer_frames = 96}).setup.buffer_frames == 96);
}

TEST_CASE("a device whose number of periods cannot be set gets a buffer of as many")
{
    const agreement a = agreed({.takes_periods = false});
    CHECK(a.setup.period_frames == 96);
    CHECK(a.setup.buffer_frames == 288);
}

TEST_CASE("the log has the requested values where the device changed them")
{
    CHECK_FALSE(within(agreed({}).log, "wished"));
    has(agreed({}, {.least_period_bytes = 4096}).log, "of 128 frames; 3 of 96 were wished");
    // The requested period, in another buffer.
    has(agreed({.buffer_frames = 384}).log, "4 of 96 frames; 3 of 96 were wished");
    has(agreed({.period_frames = 144}).log, "2 of 144 frames; 3 of 96 were wished");
}

TEST_CASE("a stream starts on request, ends with its last frame, and is silent beyond")
{
    fake_dac dac;
    const auto s = alsa::adopt(dac.pcm(), eight);
    const alsa::sw_params w = alsa::make_sw_params();
    REQUIRE(snd_pcm_sw_params_current(dac.pcm(), w.get()) == 0);
    snd_pcm_uframes_t boundary = 0;
    REQUIRE(snd_pcm_sw_params_get_boundary(w.get(), &boundary) == 0);
    const auto value = [&](auto get) {
        snd_pcm_uframes_t v = 0;
        CHECK(get(w.get(), &v) == 0);
        return v;
    };
    CHECK(value(snd_pcm_sw_params_get_start_threshold) == boundary);
    CHECK(value(snd_pcm_sw_params_get_stop_threshold) == s->setup().buffer_frames);
    CHECK(value(snd_pcm_sw_params_get_avail_min) == s->setup().period_frames);
    CHECK(value(snd_pcm_sw_params_get_silence_threshold) == 0);
    CHECK(value(snd_pcm_sw_params_get_silence_size) == boundary);
    snd_pcm_tstamp_t mode{};
    snd_pcm_tstamp_type_t type{};
    CHECK(snd_pcm_sw_params_get_tstamp_mode(w.get(), &mode) == 0);
    CHECK(snd_pcm_sw_params_get_tstamp_type(w.get(), &type) == 0);
    CHECK(mode == SND_PCM_TSTAMP_ENABLE);
    CHECK(type == SND_PCM_TSTAMP_TYPE_MONOTONIC);
}

} // namespace agreed_test
