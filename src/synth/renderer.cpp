// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <span>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "core/access.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/mix/oscillator.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/make_timbre.hpp"

namespace tactor::synth {

double plain_ramp_s(double onset_s, double duration_s, const plan& p, const render_options& o) noexcept
{
    return crosses_zero(p) ? burst_ramp_s(onset_s, duration_s, p.carrier_hz, o)
                           : o.ramp_s.value_or(default_ramp_s);
}

} // namespace tactor::synth

namespace tactor {
inline namespace v0 {

namespace {

/// Time in which a score whose plan failed falls silent, as in the player.
constexpr double fade_s = 0.01;

} // namespace

struct renderer::impl {
    /// Makes a mixer with space for the drives that sound at once, for those that begin in the block
    /// meanwhile, and for those that come after a stroke that can fail.
    impl(const score& s, format_kind f)
        : source(s),
          ahead(detail::access::of(s).open_continuous > 0 ? synth::frame_at(fade_s, s.rate()) : 0),
          mix(detail::access::of(s).limits, f,
              detail::access::of(s).open_events + 256 + 16 * detail::access::of(s).open_continuous,
              guards(detail::access::of(s))),
          frame_bytes(s.channels() * bytes_of(f))
    {
    }

    static synth::guard_settings guards(const score::impl& s)
    {
        return s.guards ? synth::make_guards(*s.guards, s.rate) : synth::guard_settings{};
    }

    /// Hands over the drives that start before a frame. Returns the frame up to which none is missing.
    std::uint64_t feed(std::uint64_t until) noexcept
    {
        for (const synth::drive_event* e = source.peek(); e != nullptr && e->start < until;
             e = source.peek()) {
            if (!mix.add(*e))
                return e->start;
            source.pop();
        }
        return until;
    }

    /// Returns the frame up to which the mixer can run now. A failure of a plan is known one fade ahead. If
    /// strokes are so crowded that there is no space for that, their fade is shorter.
    std::uint64_t prepare(std::uint64_t until) noexcept
    {
        const std::uint64_t at = mix.position();
        const std::uint64_t known = feed(until + ahead);
        const std::uint64_t ready =
            std::min(until, known > at + ahead ? known - ahead : std::max(known, at + 1));
        if (source.failure().empty())
            return ready;
        const std::uint64_t silent = source.failed_at();
        const std::uint64_t fall = silent - std::min(silent, ahead);
        if (at < fall)
            return std::min(ready, fall);
        if (!failed) {
            failed = true;
            mix.fade_out(0, static_cast<std::uint32_t>(std::max(silent, at) - at));
        }
        return ready;
    }

    synth::event_source source;
    std::uint64_t ahead; ///< frames that are read before they are mixed
    bool failed = false;
    synth::mixer mix;
    std::size_t frame_bytes;
};

namespace {

template <typename Impl>
Impl& not_moved(const std::unique_ptr<Impl>& p)
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
    impl& r = not_moved(impl_);
    if (out.size() % r.frame_bytes != 0)
        throw error(error_kind::bad_input, "renderer",
                    fmt::format("{} bytes are no whole number of frames of {}", out.size(), r.frame_bytes),
                    "give space for whole frames");
    std::size_t frames = out.size() / r.frame_bytes;
    std::byte* to = out.data();
    // Whole blocks of the mixer, several at once: short to wait for, with little work in between.
    constexpr std::uint64_t stride = std::uint64_t{8} * synth::block_frames;
    while (frames > 0) {
        const std::uint64_t at = r.mix.position();
        const std::uint64_t until = std::min(at + frames, at / stride * stride + stride);
        const auto n = static_cast<std::size_t>(r.prepare(until) - at);
        r.mix.process(n, to);
        to += n * r.frame_bytes;
        frames -= n;
    }
}

std::uint64_t renderer::position() const
{
    return not_moved(impl_).mix.position();
}

const std::string& renderer::failure() const
{
    return not_moved(impl_).source.failure();
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
