// SPDX-License-Identifier: MIT
// WAV files, and what a carrier makes of those that are taken.
#include <cmath>
#include <memory>

#include <tactor/plan.hpp>

#include "files/sound_file.hpp"
#include "holds.hpp"
#include "synth/tone/make_timbre.hpp"

using namespace tactor;

namespace {

void check_sound(const std::shared_ptr<const recording>& r, texture_kind texture)
{
    plan p;
    p.wave.kind = waveform_kind::recording;
    p.wave.recorded = r;
    p.wave.texture = texture;
    const auto t = fuzz::accepted([&] { return synth::make_timbre(p, 48000); });
    if (t == nullptr)
        return; // longer than a cycle may be, say
    synth::block samples{};
    t->fill(-7, 0, synth::block_frames, samples.data(), synth::wave::sine);
    for (const double v : samples)
        HOLDS(std::abs(v) <= 1.0 + 1e-4);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const auto r = fuzz::accepted([&] {
        return std::make_shared<const recording>(
            detail::parse_recording(fuzz::as_text(data, size), "fuzz.wav"));
    });
    if (r == nullptr)
        return 0;
    for (const float v : r->samples)
        HOLDS(std::isfinite(v));
    check_sound(r, texture_kind::cycle);
    // Longer ones take the same ways, only for longer.
    if (static_cast<double>(r->samples.size()) / r->rate_hz < 0.2)
        check_sound(r, texture_kind::time);
    return 0;
}
