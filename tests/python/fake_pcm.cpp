// SPDX-License-Identifier: MIT
// The fake DAC as an ALSA plugin: a device whose clock the test moves, opened by its name like any other.
#include <cerrno>
#include <exception>

#include "fake_dac.hpp"

namespace {

tactor::test::fake_dac* newest = nullptr; // outlives its PCM, and is never given back

} // namespace

extern "C" {

SND_PCM_PLUGIN_DEFINE_FUNC(fake)
{
    try {
        newest = new tactor::test::fake_dac;
        newest->reserve_capture(0);
        *pcmp = newest->pcm();
        return 0;
    } catch (const std::exception&) {
        return -EIO;
    }
}
SND_PCM_PLUGIN_SYMBOL(fake)

// Plays frames; an xrun where there are not so many.
void fake_play(unsigned long frames)
{
    newest->advance(frames);
}

// Waits until so many frames wait to be played.
void fake_await(unsigned long frames)
{
    newest->await([frames] { return newest->running() && newest->queued() >= frames; });
}
}
