// SPDX-License-Identifier: MIT
// Writes, a card's buffer as a ring, the pacer, and set-ups that devices agreed to.
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <alsa/asoundlib.h>
#include <dlfcn.h>
#include <doctest/doctest.h>
#include <poll.h>

#include <tactor/alsa.hpp>

#include "caught.hpp"
#include "fake_dac.hpp"
#include "has.hpp"
#include "rt/clock.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/pcm_sink.hpp"
#include "sink/pacer.hpp"

namespace {

// Answers of kernel drivers that no plugin can give.
struct device_answers {
    int card = -1;
    bool batch = false;
    bool takes_periods = true; ///< their number can be set
    std::optional<unsigned> channels = {};
    std::optional<unsigned> rate = {};
    std::optional<snd_pcm_uframes_t> period_frames = {};
    std::optional<snd_pcm_uframes_t> buffer_frames = {};
    std::optional<snd_pcm_sframes_t> delay = {};
    bool refuses_running = false; ///< does not make ready what runs, as the kernel
};

const device_answers* answers = nullptr;

// Makes every PCM answer this as long as it lives.
class device_says {
public:
    explicit device_says(const device_answers& a) { answers = &a; }
    ~device_says() { answers = nullptr; }
    device_says(const device_says&) = delete;
    device_says& operator=(const device_says&) = delete;
};

template <typename Function>
Function* real(Function*, const char* name)
{
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

} // namespace

// These replace libasound's functions in this program.
extern "C" {

int snd_pcm_info_get_card(const snd_pcm_info_t* info)
{
    return answers != nullptr ? answers->card : real(snd_pcm_info_get_card, "snd_pcm_info_get_card")(info);
}

snd_pcm_sframes_t snd_pcm_status_get_delay(const snd_pcm_status_t* s)
{
    return answers != nullptr && answers->delay
               ? *answers->delay
               : real(snd_pcm_status_get_delay, "snd_pcm_status_get_delay")(s);
}

int snd_pcm_prepare(snd_pcm_t* pcm)
{
    if (answers != nullptr && answers->refuses_running && snd_pcm_state(pcm) == SND_PCM_STATE_RUNNING)
        return -EBUSY;
    return real(snd_pcm_prepare, "snd_pcm_prepare")(pcm);
}

int snd_pcm_hw_params_is_batch(const snd_pcm_hw_params_t* p)
{
    return answers != nullptr ? static_cast<int>(answers->batch)
                              : real(snd_pcm_hw_params_is_batch, "snd_pcm_hw_params_is_batch")(p);
}

int snd_pcm_hw_params_set_periods_near(snd_pcm_t* pcm, snd_pcm_hw_params_t* p, unsigned* n, int* direction)
{
    if (answers != nullptr && !answers->takes_periods)
        return -EINVAL;
    return real(snd_pcm_hw_params_set_periods_near, "snd_pcm_hw_params_set_periods_near")(pcm, p, n,
                                                                                          direction);
}

int snd_pcm_hw_params_get_channels(const snd_pcm_hw_params_t* p, unsigned* n)
{
    const int code = real(snd_pcm_hw_params_get_channels, "snd_pcm_hw_params_get_channels")(p, n);
    if (answers != nullptr)
        *n = answers->channels.value_or(*n);
    return code;
}

int snd_pcm_hw_params_get_rate(const snd_pcm_hw_params_t* p, unsigned* n, int* direction)
{
    const int code = real(snd_pcm_hw_params_get_rate, "snd_pcm_hw_params_get_rate")(p, n, direction);
    if (answers != nullptr)
        *n = answers->rate.value_or(*n);
    return code;
}

int snd_pcm_hw_params_get_period_size(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* n, int* direction)
{
    const int code =
        real(snd_pcm_hw_params_get_period_size, "snd_pcm_hw_params_get_period_size")(p, n, direction);
    if (answers != nullptr)
        *n = answers->period_frames.value_or(*n);
    return code;
}

int snd_pcm_hw_params_get_buffer_size(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* n)
{
    const int code = real(snd_pcm_hw_params_get_buffer_size, "snd_pcm_hw_params_get_buffer_size")(p, n);
    if (answers != nullptr)
        *n = answers->buffer_frames.value_or(*n);
    return code;
}

} // extern "C"

namespace writes_test {

using namespace tactor;
using namespace tactor::test;
using detail::virtual_queue;

namespace {

// A stream that runs, with a full buffer.
struct stream {
    explicit stream(bool as_card) : out(alsa::adopt(dac.pcm(), options(), as_card)) { start(); }

    static alsa_options options()
    {
        alsa_options o{.channels = 2, .format = format_kind::s16};
        return o;
    }
    void start()
    {
        REQUIRE(out->prepare() == io_kind::ok);
        const std::vector<std::byte> silence(out->setup().buffer_frames * out->setup().frame_bytes());
        REQUIRE(out->write(silence).frames == out->setup().buffer_frames);
        REQUIRE(out->start() == io_kind::ok);
    }
    // Waits as long as the buffer lasts at the rate.
    void pass() const
    {
        const std::int64_t until =
            rt::monotonic_ns() + std::int64_t{out->setup().buffer_frames} * 1'000'000'000 / out->setup().rate;
        while (rt::monotonic_ns() < until) {
        }
    }

    fake_dac dac;
    std::unique_ptr<sink> out;
};

// Writes `frames` frames through the device's pacer; returns the most periods at a time.
std::uint64_t write_all(sink& s, std::uint64_t frames)
{
    REQUIRE(s.prepare() == io_kind::ok);
    const stream_setup& d = s.setup();
    const std::vector<std::byte> silence(d.buffer_frames * d.frame_bytes());
    REQUIRE(s.write(silence).frames == d.buffer_frames);
    REQUIRE(s.start() == io_kind::ok);
    CHECK_FALSE(d.has_clock);
    std::uint64_t wakes = 0;
    while (s.position().written < frames) {
        pollfd fd{};
        REQUIRE(s.max_descriptors() >= 1);
        REQUIRE(s.descriptors(std::span(&fd, 1)) == 1);
        REQUIRE(::poll(&fd, 1, 10'000) == 1);
        if (s.ready(std::span(&fd, 1)) != io_kind::ok)
            continue;
        ++wakes;
        const io_result r = s.write(std::span(silence).first(d.period_frames * d.frame_bytes()));
        REQUIRE(r.status == io_kind::ok);
        REQUIRE(r.frames == d.period_frames);
    }
    return wakes;
}

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

TEST_CASE("the played position never goes back, whatever delay a driver reports")
{
    stream s(false);
    s.dac.advance_queued(96);
    const stream_position p = s.out->position();
    REQUIRE(p.valid);
    REQUIRE(p.played == 96);
    const device_answers late{.delay = static_cast<snd_pcm_sframes_t>(p.written) - 40};
    const device_says it(late);
    CHECK(s.out->position().played == 96);
}

TEST_CASE("more frames in the queue than were written, a DAC's own among them, are none that were played")
{
    stream s(false);
    s.dac.advance_queued(96);
    const stream_position p = s.out->position();
    REQUIRE(p.played == 96);
    const device_answers own{.delay = static_cast<snd_pcm_sframes_t>(p.written) + 48};
    const device_says it(own);
    CHECK(s.out->position().played == 96);
    s.start(); // at the start nothing was played, and the DAC's own delay is there already
    CHECK(s.out->position().played == 0);
}

TEST_CASE("a stream that runs is stopped before it is made ready, which the kernel refuses else")
{
    stream s(false);
    const device_answers kernel{.refuses_running = true};
    const device_says it(kernel);
    REQUIRE(s.dac.running());
    s.start();
    CHECK(s.dac.starts() == 2);
}

TEST_CASE("the drive time of a PCM on a card is kept under the card's place")
{
    alsa_options o{.channels = 2};
    CHECK(open_alsa(o)->setup().device.empty()); // the null device
    const device_answers card{.card = 30};
    const device_says it(card);
    CHECK(open_alsa(o)->setup().device == "hw:CARD=30,DEV=0,SUBDEV=0");
}

TEST_CASE("every result of a write has its meaning")
{
    using alsa::classify_error;
    CHECK(classify_error(-EAGAIN, SND_PCM_STATE_RUNNING) == io_kind::again);
    CHECK(classify_error(-EINTR, SND_PCM_STATE_RUNNING) == io_kind::again);
    CHECK(classify_error(-EPIPE, SND_PCM_STATE_XRUN) == io_kind::xrun);
    CHECK(classify_error(-EPIPE, SND_PCM_STATE_RUNNING) == io_kind::xrun);
    CHECK(classify_error(-EPIPE, SND_PCM_STATE_DISCONNECTED) == io_kind::lost);
    CHECK(classify_error(-EPIPE, -ENODEV) == io_kind::lost);
    CHECK(classify_error(-ESTRPIPE, SND_PCM_STATE_SUSPENDED) == io_kind::suspended);
    CHECK(classify_error(-ENODEV, SND_PCM_STATE_RUNNING) == io_kind::lost);
    CHECK(classify_error(-ENOTTY, SND_PCM_STATE_RUNNING) == io_kind::lost);
    CHECK(classify_error(-EBADFD, SND_PCM_STATE_XRUN) == io_kind::xrun);
    CHECK(classify_error(-EBADFD, SND_PCM_STATE_SETUP) == io_kind::xrun);
    CHECK(classify_error(-EBADFD, SND_PCM_STATE_SUSPENDED) == io_kind::suspended);
    CHECK(classify_error(-EBADFD, SND_PCM_STATE_DISCONNECTED) == io_kind::lost);
    CHECK(classify_error(-EBADFD, SND_PCM_STATE_RUNNING) == io_kind::failed);
    CHECK(classify_error(-EIO, SND_PCM_STATE_RUNNING) == io_kind::failed);
    CHECK(classify_error(-ENOSPC, SND_PCM_STATE_RUNNING) == io_kind::failed);
}

TEST_CASE("a full device that has not been started takes nothing and says so")
{
    test::fake_dac dac;
    alsa_options o{.channels = 2};
    const auto s = alsa::adopt(dac.pcm(), o);
    REQUIRE(s->prepare() == io_kind::ok);
    const std::vector<std::byte> silence(1000 * 8);
    const auto ten_frames = std::span(silence).first(10 * s->setup().frame_bytes());
    CHECK(s->write(silence).frames == s->setup().buffer_frames);
    const io_result r = s->write(ten_frames);
    CHECK(r.status == io_kind::again);
    CHECK(r.frames == 0);
    CHECK_FALSE(s->position().valid);
    REQUIRE(s->start() == io_kind::ok);
    CHECK(s->write(ten_frames).status == io_kind::again);
    dac.advance(96);
    CHECK(s->position().valid);
    CHECK(s->position().written == 288);
    CHECK(s->position().played == 96);
    CHECK(s->available().frames == 96);
    s->drop();
    CHECK_FALSE(dac.running());
}

TEST_CASE("a card whose position moved, unseen for a whole buffer, has had an xrun")
{
    stream s(true);
    s.pass();
    s.dac.advance(96); // of the round before it the position tells nothing
    const io_result r = s.out->available();
    CHECK(r.status == io_kind::xrun);
    CHECK(s.out->xrun_ns() >= 0);
    CHECK(s.out->available().status == io_kind::xrun); // until it is made ready again
    s.start();
    s.pass();
    CHECK(s.out->available().status == io_kind::ok); // it stands still
    s.pass();
    s.dac.advance(96);
    CHECK(s.out->position().valid); // an earlier read does not hide it
    CHECK(s.out->available().status == io_kind::xrun);
}

TEST_CASE("cards of the kernel, the first one too, have a ring")
{
    for (const int card : {-1, 0, 3}) {
        CAPTURE(card);
        const device_answers answers{.card = card};
        const device_says it(answers);
        stream s(false);
        s.pass();
        s.dac.advance(96);
        CHECK(s.out->available().status == (card < 0 ? io_kind::ok : io_kind::xrun));
    }
}

TEST_CASE("a virtual queue plays at its rate, without drift over a week")
{
    for (const unsigned rate : {8000U, 44100U, 48000U, 192000U, 11025U}) {
        CAPTURE(rate);
        virtual_queue q(rate, 300);
        const std::int64_t origin = 123'456'789;
        q.start(origin, 0);
        const std::uint64_t week = std::uint64_t{7} * 24 * 3600 * rate;
        q.wrote(week + 300);
        CHECK(q.played(origin) == 0);
        CHECK(q.played(origin + 1'000'000'000) == rate);
        CHECK(q.played(origin + std::int64_t{7} * 24 * 3600 * 1'000'000'000) == week);
        CHECK(q.played(origin + std::int64_t{7} * 24 * 3600 * 1'000'000'000 - 1) == week - 1);
    }
}

TEST_CASE("at the deadline the period fits, and not before")
{
    std::mt19937_64 random(1);
    for (int round = 0; round < 200; ++round) {
        const auto rate = static_cast<unsigned>(8000 + random() % 184'001);
        const auto period = 1 + random() % 500;
        const auto buffer = period * (2 + random() % 4);
        virtual_queue q(rate, static_cast<unsigned>(buffer));
        std::int64_t now = static_cast<std::int64_t>(random() % 1'000'000'000'000);
        q.start(now, buffer);
        for (int i = 0; i < 100; ++i) {
            const std::int64_t t = q.room_time_ns(period);
            REQUIRE(t > now);
            REQUIRE(q.available(t - 1) < period);
            REQUIRE(q.available(t) >= period);
            now = t;
            q.wrote(period);
        }
    }
}

TEST_CASE("a writer that comes too late stops the virtual clock, and nothing is lost")
{
    virtual_queue q(48000, 288);
    q.start(0, 288);
    const std::int64_t late = 10'000'000'000;
    CHECK(q.played(late) == 288);
    CHECK(q.available(late) == 288);
    q.wrote(96);
    CHECK(q.played(late) == 288);
    CHECK(q.played(late + 1'000'000) == 336);
    CHECK(q.room_time_ns(288) == late + 2'000'000);
}

TEST_CASE("the timer becomes readable when a period fits")
{
    detail::pacer p(48000, 288, 96);
    const std::int64_t begun = rt::monotonic_ns();
    p.start(288);
    p.arm();
    pollfd fd{.fd = p.fd(), .events = POLLIN, .revents = 0};
    while (!p.due()) {
        REQUIRE(::poll(&fd, 1, 10'000) == 1);
        p.arm();
    }
    CHECK(p.available() >= 96);
    CHECK(rt::monotonic_ns() - begun >= 2'000'000); // 96 frames
    p.arm();
    CHECK(::poll(&fd, 1, 10'000) == 1); // the space is still there
}

TEST_CASE("null, file, plug and multi of nulls are found to have no clock, and are paced")
{
    const std::string nulls =
        "pcm.n { type null }\n"
        "pcm.file { type file slave.pcm n file \"/dev/null\" format raw }\n"
        "pcm.plug { type plug slave.pcm n }\n"
        "pcm.linear { type linear slave { pcm n format S16_LE } }\n"
        "pcm.multi { type multi slaves.a { pcm n channels 1 } slaves.b { pcm n channels 1 }\n"
        "  bindings.0 { slave a channel 0 } bindings.1 { slave b channel 0 } }\n"
        "pcm.pluggedmulti { type plug slave.pcm multi }\n"
        "pcm.null { type null }\n";
    for (const char* name : {"null", "file", "plug", "linear", "multi", "pluggedmulti"}) {
        CAPTURE(name);
        alsa_options o{.pcm = name, .channels = 2, .config_text = nulls};
        const auto s = open_alsa(o);
        const std::int64_t begun = rt::monotonic_ns();
        const std::uint64_t wakes = write_all(*s, 288 + 20 * 96);
        CHECK(wakes == 20);
        // 20 periods take 40 ms, and the first is not awaited in full.
        CHECK(rt::monotonic_ns() - begun > 36'000'000);
        s->drop();
    }
}

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
        const std::string said = caught_message([&] { agreed(a); });
        has(said,
            "8 channels at 48000 Hz in s32, float, s24, s24-4, s16 were requested, but it opened with ");
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
    has(agreed({}, {.least_period_bytes = 4096}).log, "of 128 frames; 3 of 96 were requested");
    // The requested period, in another buffer.
    has(agreed({.buffer_frames = 384}).log, "4 of 96 frames; 3 of 96 were requested");
    has(agreed({.period_frames = 144}).log, "2 of 144 frames; 3 of 96 were requested");
}

TEST_CASE("a stream starts on request, ends with its last frame, and is silent beyond")
{
    fake_dac dac;
    const auto s = alsa::adopt(dac.pcm(), eight);
    const alsa::sw_params w = alsa::allocate<alsa::sw_params>(snd_pcm_sw_params_malloc);
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

} // namespace writes_test
