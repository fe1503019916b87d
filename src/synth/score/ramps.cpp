// SPDX-License-Identifier: MIT
#include "synth/score/ramps.hpp"

#include "synth/score/frames.hpp"
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
