// SPDX-License-Identifier: MIT
// Sensation levels of tactors whose thresholds are known at several frequencies.
#include <algorithm>
#include <cmath>

#include "plan/job.hpp"
#include "synth/score/levels.hpp"
#include "synth/score/score.hpp"

namespace tactor {
inline namespace v0 {

namespace {

/// Returns the carrier of a plan at a time of it.
double hz_at(const plan& p, double t_s)
{
    // For a recording along the path the course holds its repetition rate.
    if (p.course.empty() || p.wave.kind == waveform_kind::recording)
        return p.carrier_hz;
    const auto after = std::upper_bound(p.course.begin(), p.course.end(), t_s,
                                        [](double t, const carrier_point& c) { return t < c.t_s; });
    if (after == p.course.begin())
        return after->hz;
    const carrier_point& before = *(after - 1);
    if (after == p.course.end())
        return before.hz;
    return detail::hz_between(before, *after, (t_s - before.t_s) / (after->t_s - before.t_s));
}

} // namespace

double score::impl::equalised(std::size_t tactor, std::uint32_t plan, std::uint64_t frame) const
{
    if (measured.empty())
        return 1.0;
    const double t_s = (static_cast<double>(frame) - static_cast<double>(starts[plan])) / rate;
    return synth::threshold_factor(measured[tactor], hz_at(plans[plan].plan, t_s));
}

double score::impl::most_equalised(std::size_t tactor, std::uint32_t plan) const
{
    if (measured.empty())
        return 1.0;
    const tactor_spec& t = measured[tactor];
    const tactor::plan& p = plans[plan].plan;
    double most = synth::threshold_factor(t, hz_at(p, 0.0));
    double low = p.carrier_hz;
    double high = p.carrier_hz;
    for (const carrier_point& c : p.course) {
        most = std::max(most, synth::threshold_factor(t, hz_at(p, c.t_s)));
        low = std::min(low, c.hz);
        high = std::max(high, c.hz);
    }
    // Between two points of the course the carrier may pass one of the thresholds.
    for (const threshold_point& q : t.thresholds)
        if (q.hz > low && q.hz < high)
            most = std::max(most, synth::threshold_factor(t, q.hz));
    return most;
}

} // namespace v0
} // namespace tactor

namespace tactor::synth {

double threshold_factor(const tactor_spec& t, double hz)
{
    if (t.thresholds.empty())
        return 1.0;
    const double db = *threshold_at(t, hz) - *threshold_at(t, reference_hz);
    return std::pow(10.0, db / 20.0);
}

} // namespace tactor::synth
