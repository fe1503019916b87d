// SPDX-License-Identifier: MIT
#include "synth/continuous_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/trajectory_spans.hpp"
#include "plan/continuous.hpp"
#include "synth/expander.hpp"

namespace tactor::synth {

namespace {

class look {
public:
    look(const plan& p, const std::vector<tactor_level>& tactors)
        : plan_(p),
          tactors_(tactors),
          last_(static_cast<std::uint64_t>(std::ceil(p.stroke_duration_s / continuous_step_s))),
          peaks_(tactors.size(), 0.0)
    {
    }

    /// All control points from a time to another, both included, that were not looked at yet.
    void at_points(double from_s, double to_s)
    {
        next_ = std::max(next_, static_cast<std::uint64_t>(from_s / continuous_step_s));
        const auto end = static_cast<std::uint64_t>(std::ceil(to_s / continuous_step_s));
        for (; next_ <= std::min(end, last_); ++next_) {
            at_point(std::min(static_cast<double>(next_) * continuous_step_s, plan_.stroke_duration_s));
        }
    }

    void at_all() { at_points(0.0, plan_.stroke_duration_s); }

    /// As if the target went over every tactor.
    void everywhere(double intensity)
    {
        for (std::size_t i = 0; i < peaks_.size(); ++i) {
            peaks_[i] = std::max(peaks_[i], std::abs(intensity * tactors_[i].gain));
        }
    }

    std::vector<double> peaks() && { return std::move(peaks_); }

private:
    void at_point(double t_s)
    {
        plan_.at(t_s, now_);
        check_drives(now_, t_s, peaks_.size());
        for (const drive& d : now_.drives) {
            peaks_[d.tactor] = std::max(peaks_[d.tactor], std::abs(d.amplitude * tactors_[d.tactor].gain));
        }
    }

    const plan& plan_;
    const std::vector<tactor_level>& tactors_;
    std::uint64_t last_; ///< control point, at the end or beyond it
    std::uint64_t next_ = 0;
    std::vector<double> peaks_;
    burst now_;
};

/// What make_plan() made with a model of the library; null for other plans.
const detail::continuous_at* known(const plan& p)
{
    const auto* at = p.at.target<detail::continuous_at>();
    return at != nullptr && at->bounded ? at : nullptr;
}

} // namespace

std::optional<double> greatest_intensity(const plan& p)
{
    const detail::continuous_at* at = known(p);
    if (at == nullptr) {
        return std::nullopt;
    }
    double greatest = 0.0;
    detail::for_each_span(at->motion, [&](const detail::trajectory_span& s) {
        greatest = s.intensity <= greatest ? greatest : s.intensity;
        return std::isfinite(greatest);
    });
    return greatest;
}

std::vector<double> continuous_peaks(const plan& p, const std::vector<tactor_level>& tactors, double harmless,
                                     std::uint64_t most)
{
    look l(p, tactors);
    const detail::continuous_at* at = known(p);
    if (at == nullptr) {
        l.at_all();
        return std::move(l).peaks();
    }
    const double looked_s = static_cast<double>(most) * continuous_step_s;
    detail::for_each_span(at->motion, [&](const detail::trajectory_span& s) {
        if (s.intensity <= harmless) {
            return true;
        }
        if (s.from_s < looked_s) {
            l.at_points(s.from_s, std::min(s.to_s, looked_s));
        }
        if (s.to_s > looked_s) {
            l.everywhere(s.intensity);
        }
        return true;
    });
    return std::move(l).peaks();
}

} // namespace tactor::synth
