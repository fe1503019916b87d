// SPDX-License-Identifier: MIT
// A card's buffer as a ring: a stream unattended for a whole ring has run dry, whatever the kernel says.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>

#include "device_says.hpp"
#include "fake_dac.hpp"
#include "rt/clock.hpp"
#include "sink/alsa/adopt.hpp"

namespace ring_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// A stream that runs, with a full buffer.
struct stream {
    explicit stream(bool as_card) : out(alsa::adopt(dac.pcm(), options(), as_card)) { start(); }

    static alsa_options options()
    {
        alsa_options o;
        o.channels = 2;
        o.format = format_kind::s16;
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

} // namespace

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

TEST_CASE("a device without a ring is believed")
{
    stream s(false);
    s.pass();
    s.dac.advance(96);
    CHECK(s.out->available().status == io_kind::ok);
}

TEST_CASE("cards of the kernel, the first one too, have a ring")
{
    for (const int card : {-1, 0, 3}) {
        CAPTURE(card);
        const test::device_answers answers{.card = card};
        const test::device_says it(answers);
        stream s(false);
        s.pass();
        s.dac.advance(96);
        CHECK(s.out->available().status == (card < 0 ? io_kind::ok : io_kind::xrun));
    }
}

} // namespace ring_test
