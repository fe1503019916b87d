// SPDX-License-Identifier: MIT
// Results of writing to a PCM.
#include <cerrno>
#include <cstddef>
#include <span>
#include <vector>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>

#include "fake_dac.hpp"
#include "sink/alsa/adopt.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace writes_test {

using namespace tactor;

TEST_CASE("every result of a write has its meaning")
{
    using alsa::of_error;
    CHECK(of_error(-EAGAIN, SND_PCM_STATE_RUNNING) == io_kind::again);
    CHECK(of_error(-EINTR, SND_PCM_STATE_RUNNING) == io_kind::again);
    CHECK(of_error(-EPIPE, SND_PCM_STATE_XRUN) == io_kind::xrun);
    CHECK(of_error(-EPIPE, SND_PCM_STATE_RUNNING) == io_kind::xrun);
    CHECK(of_error(-EPIPE, SND_PCM_STATE_DISCONNECTED) == io_kind::lost);
    CHECK(of_error(-EPIPE, -ENODEV) == io_kind::lost);
    CHECK(of_error(-ESTRPIPE, SND_PCM_STATE_SUSPENDED) == io_kind::suspended);
    CHECK(of_error(-ENODEV, SND_PCM_STATE_RUNNING) == io_kind::lost);
    CHECK(of_error(-ENOTTY, SND_PCM_STATE_RUNNING) == io_kind::lost);
    CHECK(of_error(-EBADFD, SND_PCM_STATE_XRUN) == io_kind::xrun);
    CHECK(of_error(-EBADFD, SND_PCM_STATE_SETUP) == io_kind::xrun);
    CHECK(of_error(-EBADFD, SND_PCM_STATE_SUSPENDED) == io_kind::suspended);
    CHECK(of_error(-EBADFD, SND_PCM_STATE_DISCONNECTED) == io_kind::lost);
    CHECK(of_error(-EBADFD, SND_PCM_STATE_RUNNING) == io_kind::failed);
    CHECK(of_error(-EIO, SND_PCM_STATE_RUNNING) == io_kind::failed);
    CHECK(of_error(-ENOSPC, SND_PCM_STATE_RUNNING) == io_kind::failed);
}

TEST_CASE("a full device that has not been started takes nothing and says so")
{
    test::fake_dac dac;
    alsa_options o;
    o.channels = 2;
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

} // namespace writes_test
