// SPDX-License-Identifier: MIT
// Renders a stroke along an SVG path to a WAV file, one channel per tactor.
//   render_wav FILE.wav
#include <cstdio>
#include <exception>

#include <tactor/tactor.hpp>

int main(int argc, char** argv)
try {
    if (argc != 2) {
        std::fprintf(stderr, "usage: render_wav FILE.wav\n");
        return 2;
    }
    const tactor::array palm = tactor::preset_array("palm-3x3");
    const tactor::path path = tactor::path::from_svg("M 0 10 C 20 -5 20 45 40 30");
    const double speed_mm_s = 80.0;
    const tactor::stroke stroke{"curve", tactor::trajectory::along(path, path.length_mm() / speed_mm_s)};

    // Another phantom model than the default, and a peak of -6 instead of -12 dBFS.
    const tactor::plan plan = tactor::make_plan(palm, stroke, {.phantom = tactor::phantom_kind::barycentric});
    const tactor::score score(palm, plan, {.level_dbfs = -6.0});
    // The same samples that a player would send to a device, without one.
    tactor::write_wav(score, tactor::format_kind::s24_3, argv[1]);
    std::printf("%s: %u channels, %.3f s\n", argv[1], score.channels(),
                static_cast<double>(score.frames()) / score.rate());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "render_wav: %s\n", e.what());
    return 1;
}
