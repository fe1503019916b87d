// SPDX-License-Identifier: MIT
// A minimal program that embeds tactor.
#include <cstdio>

#include <tactor/tactor.hpp>

int main()
{
    const tactor::array palm = tactor::preset_array("palm-3x3");
    const tactor::stroke stroke{"line",
                                tactor::trajectory::along(tactor::path::from_svg("M 0 0 L 40 0"), 0.5)};
    const tactor::score score(palm, tactor::make_plan(palm, stroke));
    tactor::player player(tactor::open_alsa({.pcm = "null", .channels = score.channels()}), palm);
    const auto report = player.wait(player.submit(score));
    std::printf("tactor %s: %s\n", tactor::version(), to_string(report->state).data());
    return 0;
}
