// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "core/access.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/drive_room.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/make_timbre.hpp"
#include "synth/tone/timbre.hpp"
#include "synth/wave/oscillator.hpp"

namespace tactor::synth {

double plain_ramp_s(double onset_s, double duration_s, const plan& p, const render_options& o) noexcept
{
    return crosses_zero(p) ? burst_ramp_s(onset_s, duration_s, p.carrier_hz, o)
                           : o.ramp_s.value_or(default_ramp_s);
}

/// A mixer and the source of a score's drives.
struct score_mixer {
    /// Makes a mixer with space for the drives that sound at once and for those that begin in the block.
    score_mixer(const score& s, format_kind f)
        : source(s),
          mix(detail::access::of(s).limits, f, detail::access::of(s).open_events + 256,
              detail::access::of(s).guards),
          frame_bytes(s.channels() * sample_bytes(f))
    {
    }

    /// Adds the drives that start before a frame. Returns the frame before which all drives have been added.
    std::uint64_t feed(std::uint64_t until)
    {
        for (const drive_event* e = source.peek(); e != nullptr && e->start < until; e = source.peek()) {
            if (!mix.add(*e))
                return e->start;
            source.pop();
        }
        return until;
    }

    /// Renders the next frames.
    void process(std::size_t frames, std::byte* to)
    {
        // A step is a few whole blocks of the mixer: it is short, and has little overhead.
        constexpr std::uint64_t stride = std::uint64_t{8} * block_frames;
        while (frames > 0) {
            const std::uint64_t at = mix.position();
            const std::uint64_t until = std::min(at + frames, at / stride * stride + stride);
            const auto n = static_cast<std::size_t>(std::max(feed(until), at + 1) - at);
            mix.process(n, to);
            to += n * frame_bytes;
            frames -= n;
        }
    }

    event_source source;
    mixer mix;
    std::size_t frame_bytes;
};

bool is_power_limited(const score& s)
{
    constexpr std::uint64_t most_frames = 4096;
    const score::impl& own = detail::access::of(s);
    const double reached =
        std::inner_product(own.peaks.begin(), own.peaks.end(), own.peaks.begin(), own.marker ? 1.0 : 0.0);
    if (!own.boosted && reached * most_power < own.guards.power)
        return false;
    score_mixer m(s, format_kind::float32);
    std::vector<std::byte> unused(most_frames * m.frame_bytes);
    while (m.mix.position() < s.frames() && m.mix.counts().power_limited == 0)
        m.process(static_cast<std::size_t>(std::min(most_frames, s.frames() - m.mix.position())),
                  unused.data());
    return m.mix.counts().power_limited != 0;
}

} // namespace tactor::synth

namespace tactor {
inline namespace v0 {

struct renderer::impl : synth::score_mixer {
    using score_mixer::score_mixer;
};

namespace {

template <typename Impl>
Impl& require_impl(const std::unique_ptr<Impl>& p)
{
    if (p == nullptr)
        throw error(error_kind::bad_input, "renderer", "it was moved from",
                    "use the one that it was moved to");
    return *p;
}

} // namespace

renderer::renderer(const score& s, format_kind f) : impl_(std::make_unique<impl>(s, f))
{
}

renderer::~renderer() = default;
renderer::renderer(renderer&&) noexcept = default;
renderer& renderer::operator=(renderer&&) noexcept = default;

void renderer::process(std::span<std::byte> out)
{
    impl& r = require_impl(impl_);
    if (out.size() % r.frame_bytes != 0)
        throw error(error_kind::bad_input, "renderer",
                    fmt::format("{} bytes are not a whole number of frames of {}", out.size(), r.frame_bytes),
                    "give space for whole frames");
    r.process(out.size() / r.frame_bytes, out.data());
}

std::uint64_t renderer::position() const
{
    return require_impl(impl_).mix.position();
}

double burst_ramp_s(double onset_s, double duration_s, double carrier_hz, const render_options& o) noexcept
{
    const double carrier_s = o.phase == phase_kind::stroke ? onset_s : 0.0;
    return synth::ramp_seconds(o.ramp_s, carrier_s, duration_s, carrier_hz);
}

double burst_ramp_s(double onset_s, double duration_s, const plan& p, const render_options& o) noexcept
{
    if (o.envelope.kind == envelope_kind::tukey)
        return 0.5 * o.envelope.tukey_part * duration_s;
    return o.envelope.attack_s.value_or(synth::plain_ramp_s(onset_s, duration_s, p, o));
}

} // namespace v0
} // namespace tactor
