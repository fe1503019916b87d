// SPDX-License-Identifier: MIT
// Messages of libasound: heard where asked for, and nowhere else.
#include <cstdarg>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "sink/alsa/library_messages.hpp"

namespace library_messages_test {

using namespace tactor;

TEST_CASE("the host program keeps its handlers of libasound's messages")
{
    const auto fails = [] { CHECK_THROWS_AS(open_alsa({.pcm = "no-such-pcm", .channels = 1}), error); };
    const auto host = snd_lib_error;
    fails();
    const bool kept = snd_lib_error == host;
    CHECK(kept);

    static unsigned heard = 0;
    const auto own = [](const char*, int, const char*, int, const char*, va_list) { ++heard; };
    const snd_local_error_handler_t before = alsa::set_local_handler(own);
    fails();
    { // These messages are the error's detail, not the host's, and in between its own calls are its own.
        const auto sink = open_alsa({.pcm = "null", .channels = 1});
        CHECK(heard == 0);
        snd_pcm_t* p = nullptr;
        CHECK(snd_pcm_open(&p, "no-such-pcm", SND_PCM_STREAM_PLAYBACK, 0) < 0);
        CHECK(heard != 0);
    }
    const bool restored = alsa::set_local_handler(before) == static_cast<snd_local_error_handler_t>(own);
    CHECK(restored);
}

TEST_CASE("nested listeners hear the inner messages, and the outer one continues")
{
    const alsa::library_messages outer;
    {
        const alsa::library_messages inner;
        SNDERR("one");
        SNDERR("two");
        CHECK(inner.first() == "one");
    }
    CHECK(outer.first() == "");
    SNDERR("three \n");
    CHECK(outer.first() == "three");
}

} // namespace library_messages_test
