// SPDX-License-Identifier: MIT
// Plays a stroke of Park et al. 2016 on a device and waits until it has been felt.
//   play_preset [PCM]        default: null, which needs no hardware
#include <cstdio>
#include <exception>

#include <tactor/tactor.hpp>

int main(int argc, char** argv)
try {
    // Plain values first: the array, the stroke, the plan of bursts, and the score with level and rate.
    const tactor::array palm = tactor::preset_array("palm-3x3");
    const tactor::stroke stroke = tactor::preset_stroke("park2016-3");

    const tactor::plan plan = tactor::make_plan(palm, stroke);
    // Weak, for the first time on a card: then come up in steps of 6 dB.
    const tactor::score score(palm, plan, {.level_dbfs = -40.0});

    tactor::alsa_options device;
    device.pcm = argc > 1 ? argv[1] : "null";
    device.channels = score.channels();
    device.wider = true; // on a card with more channels the others are silent
    device.rate = score.rate();
    // Opens the device and starts the stream, silent. Keep it: strokes then start within milliseconds.
    tactor::player player(tactor::open_alsa(device), palm);

    // submit() returns at once and may be called from any thread; wait() blocks until the stroke has ended.
    const tactor::stroke_id id = player.submit(score);
    const auto report = player.wait(id);
    std::printf("%s after %llu frames\n", std::string(to_string(report->state)).c_str(),
                static_cast<unsigned long long>(report->frames));
    return report->state == tactor::state_kind::finished ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "play_preset: %s\n", e.what());
    return 1;
}
