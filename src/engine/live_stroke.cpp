// SPDX-License-Identifier: MIT
#include "engine/live_stroke.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "plan/job.hpp"
#include "synth/frames.hpp"
#include "synth/levels.hpp"
#include "synth/mixer.hpp"

namespace tactor {
namespace {

using engine::least_live_soa_s;

void check(const live_options& o, unsigned rate)
{
    if (o.plan.method == algorithm::tactile_brush)
        throw error(errc::bad_input, "live stroke", "Tactile Brush must know the whole path beforehand",
                    "use continuous or park2016");
    if (!(o.plan.carrier_hz > 0.0 && o.plan.carrier_hz < 0.5 * rate))
        throw error(
            errc::bad_input, "live stroke",
            fmt::format("a carrier of {} Hz cannot be rendered at a rate of {} Hz", o.plan.carrier_hz, rate),
            "250 is usual");
    if (!(o.timeout_s >= 0.001 && o.timeout_s <= 86400.0))
        throw error(errc::bad_input, "live stroke", fmt::format("a time-out of {} s", o.timeout_s),
                    "give 0.001 to 86400 s");
    if (o.render.ramp_s && !(*o.render.ramp_s >= 0.0 && *o.render.ramp_s <= 1.0))
        throw error(errc::bad_input, "live stroke", fmt::format("a ramp of {} s", *o.render.ramp_s),
                    "give 0 to 1 s");
}

engine::live_setup live_setup(const stream_setup& s, const live_options& o)
{
    check(o, s.rate);
    engine::live_setup l;
    l.channels = s.channels;
    l.cycles_per_frame = o.plan.carrier_hz / s.rate;
    l.step = std::max<std::uint64_t>(synth::frame_at(continuous_step_s, s.rate), 1);
    l.timeout = synth::frame_at(o.timeout_s, s.rate);
    l.bursts = o.plan.method == algorithm::park2016;
    if (!l.bursts)
        return l;
    const double duration_s = burst_duration_s(o.plan);
    if (o.plan.soa_s < least_live_soa_s)
        throw error(errc::bad_input, "live stroke", fmt::format("an SOA of {} s", o.plan.soa_s),
                    fmt::format("{} s or more", least_live_soa_s));
    l.soa = synth::frame_at(o.plan.soa_s, s.rate);
    l.duration = std::min(synth::frame_at(duration_s, s.rate), l.soa);
    l.restart = o.render.phase == phase_mode::burst;
    const auto ramp = [&](std::optional<double> ramp_s) {
        return synth::ramp_frames(ramp_s, 0.0, duration_s, o.plan.carrier_hz, s.rate, l.duration);
    };
    // With a restart all bursts are alike; else each has its place on the carrier.
    l.ramp = ramp(l.restart ? o.render.ramp_s : o.render.ramp_s.value_or(0.0));
    l.cut_ramp = l.restart ? l.ramp : ramp(o.render.ramp_s.value_or(synth::default_ramp_s));
    return l;
}

} // namespace

live_stroke::impl::impl(stroke_id number, const array& a, const layout& l, const stream_setup& s,
                        const live_options& o)
    : id(number),
      faces(l),
      model(o.plan.custom_phantom ? o.plan.custom_phantom : make_phantom(o.plan.phantom, l)),
      leave(o.plan.leave),
      levels(synth::tactor_levels(a, o.render)),
      limits(synth::channel_limits(a, s.channels)),
      voice(live_setup(s, o))
{
    drives.reserve(a.tactors.size());
}

bool live_stroke::impl::to(point p, double intensity)
{
    if (!std::isfinite(p.x_mm) || !std::isfinite(p.y_mm))
        throw error(errc::bad_input, "live stroke", fmt::format("the point ({}, {})", p.x_mm, p.y_mm),
                    "finite millimetres");
    const std::lock_guard lock(mutex);
    if (voice.closed() || voice.asked() != engine::live_voice::wish::go_on)
        return false;
    const bool inside = faces.contains(p);
    if (!inside && leave == outside::error)
        throw error(errc::bad_input, "live stroke",
                    fmt::format("({:.6g}, {:.6g}) is outside the array", p.x_mm, p.y_mm),
                    "outside::clamp plays the nearest point of the array");
    detail::drives_at(*model, faces, inside ? p : faces.nearest(p), intensity, drives);

    std::vector<double>& by_channel = voice.draft();
    std::fill(by_channel.begin(), by_channel.end(), 0.0);
    bool limited = false;
    for (const drive& d : drives) {
        const synth::tactor_level& t = levels[d.tactor];
        if (t.channel >= by_channel.size())
            continue;
        const double asked = t.gain * d.amplitude;
        const double limit = limits[t.channel];
        by_channel[t.channel] = std::clamp(asked, -limit, limit);
        limited = limited || std::abs(asked) > limit;
    }
    voice.publish();
    points.fetch_add(1, std::memory_order_relaxed);
    outside_points.fetch_add(inside ? 0 : 1, std::memory_order_relaxed);
    limited_points.fetch_add(limited ? 1 : 0, std::memory_order_relaxed);
    return true;
}

live_stroke::live_stroke(std::shared_ptr<impl> p) : impl_(std::move(p))
{
    if (impl_ == nullptr)
        throw error(errc::bad_input, "live stroke", "there is none", "begin one with player::begin()");
}

stroke_id live_stroke::id() const noexcept
{
    return impl_->id;
}

bool live_stroke::to(double x_mm, double y_mm, double intensity)
{
    return impl_->to({x_mm, y_mm}, intensity);
}

void live_stroke::end() noexcept
{
    impl_->voice.ask(engine::live_voice::wish::end);
}

void live_stroke::cancel() noexcept
{
    impl_->voice.ask(engine::live_voice::wish::cancel);
}

bool live_stroke::open() const noexcept
{
    return !impl_->voice.closed() && impl_->voice.asked() == engine::live_voice::wish::go_on;
}

live_counts live_stroke::counts() const noexcept
{
    return {.points = impl_->points.load(std::memory_order_relaxed),
            .outside = impl_->outside_points.load(std::memory_order_relaxed),
            .limited = impl_->limited_points.load(std::memory_order_relaxed)};
}

} // namespace tactor
