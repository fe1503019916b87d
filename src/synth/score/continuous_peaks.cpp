// SPDX-License-Identifier: MIT
#include "synth/score/continuous_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/trajectory/spans.hpp"
#include "plan/curve_impl.hpp"
#include "synth/score/expander.hpp"

namespace tactor::synth {

namespace {

class look {
public:
    look(const plan& p, std::size_t tactors) : plan_(p), last_(p.curve->size() - 1), peaks_(tactors, 0.0) {}

    /// All control points from a time to another, both included, that were not looked at yet.
    void at_points(double from_s, double to_s)
    {
        next_ = std::max(next_, static_cast<std::uint64_t>(from_s / continuous_step_s));
        const auto end = static_cast<std::uint64_t>(std::ceil(to_s / continuous_step_s));
        for (; next_ <= std::min(end, last_); ++next_)
            at_point(next_);
    }

    void at_all() { at_points(0.0, plan_.stroke_duration_s); }

    /// As if the target went over every tactor.
    void everywhere(double intensity)
    {
        for (double& peak : peaks_)
            peak = std::max(peak, intensity);
    }

    std::vector<double> peaks() && { return std::move(peaks_); }

private:
    void at_point(std::uint64_t k)
    {
        curve_access::of(*plan_.curve).sample(k, seen_, now_);
        check_drives(now_, now_.onset_s, peaks_.size());
        for (const drive& d : now_.drives)
            peaks_[d.tactor] = std::max(peaks_[d.tactor], std::abs(d.amplitude));
    }

    const plan& plan_;
    std::uint64_t last_; ///< control point, at the end or beyond it
    std::uint64_t next_ = 0;
    std::vector<double> peaks_;
    burst now_;
    detail::same_tactors seen_;
};

/// The movement behind a plan, where none of its tactors gets more than its intensity; null for others.
const trajectory* known(const plan& p)
{
    return curve_access::of(*p.curve).bounds();
}

} // namespace

std::optional<double> greatest_intensity(const plan& p)
{
    const trajectory* motion = known(p);
    if (motion == nullptr)
        return std::nullopt;
    double greatest = 0.0;
    detail::for_each_span(*motion, [&](const detail::trajectory_span& s) {
        greatest = s.intensity <= greatest ? greatest : s.intensity;
        return std::isfinite(greatest);
    });
    return greatest;
}

std::vector<double> continuous_peaks(const plan& p, std::size_t tactors, double harmless, std::uint64_t most)
{
    look l(p, tactors);
    const trajectory* motion = known(p);
    if (motion == nullptr) {
        l.at_all();
        return std::move(l).peaks();
    }
    const double looked_s = static_cast<double>(most) * continuous_step_s;
    detail::for_each_span(*motion, [&](const detail::trajectory_span& s) {
        const bool looked_at = !(s.intensity <= harmless);
        if (looked_at && s.from_s < looked_s)
            l.at_points(s.from_s, std::min(s.to_s, looked_s));
        if (!looked_at || s.to_s > looked_s)
            l.everywhere(s.intensity);
        return true;
    });
    return std::move(l).peaks();
}

} // namespace tactor::synth
