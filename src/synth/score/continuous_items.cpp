// SPDX-License-Identifier: MIT
#include "synth/score/continuous_items.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "core/trajectory/spans.hpp"
#include "plan/curve_impl.hpp"
#include "synth/score/expander.hpp"
#include "synth/score/levels.hpp"

namespace tactor::synth {
namespace {

/// Control points of a stroke that overlaps others that are looked at one by one: 70 minutes.
constexpr std::uint64_t most_overlapping_points = std::uint64_t{1} << 22;

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

/// The movement behind a plan, where none of so many tactors gets more than its intensity; null for others.
const trajectory* known(const plan& p, std::size_t tactors)
{
    return curve_access::of(*p.curve).bounds(tactors);
}

/// Returns the greatest intensity of a continuous plan, as an upper bound of the amplitudes that it asks for.
/// None where the intensity is not known to be a bound. May be infinite or no number.
std::optional<double> greatest_intensity(const plan& p, std::size_t tactors)
{
    const trajectory* motion = known(p, tactors);
    if (motion == nullptr)
        return std::nullopt;
    double greatest = 0.0;
    detail::for_each_span(*motion, [&](const detail::trajectory_span& s) {
        greatest = s.intensity <= greatest ? greatest : s.intensity;
        return std::isfinite(greatest);
    });
    return greatest;
}

/// Returns the greatest amplitude that a continuous plan asks of each of so many tactors in any control
/// point; between them the amplitude is linear. If make_plan() made the plan with a model of the library, no
/// tactor gets more than the intensity, which is linear between the points of a trajectory. In such a plan,
/// control points are not looked at in two cases; every tactor then counts as driven with the intensity
/// itself, wherever the target is:
/// - where the intensity is `harmless` or less;
/// - beyond the first `most` control points.
/// In any other plan each control point is looked at.
/// \throws error (bad_input) where the plan drives a tactor that is not there, or gives an impossible
///         amplitude.
std::vector<double> continuous_peaks(const plan& p, std::size_t tactors, double harmless, std::uint64_t most)
{
    look l(p, tactors);
    const trajectory* motion = known(p, tactors);
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

/// For each item whether another one may sound together with it; markers do not count. Items go by start.
std::vector<bool> overlapping(const score::impl& s)
{
    const std::deque<item>& items = s.list.items;
    std::vector<bool> overlaps(items.size(), false);
    std::uint64_t end = 0; // of those before
    std::size_t longest = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const item& it = items[i];
        if (it.kind == item_kind::marker)
            continue;
        if (s.heard_from(it) < end) {
            overlaps[i] = true;
            overlaps[longest] = true;
        }
        if (it.end() > end) {
            end = it.end();
            longest = i;
        }
    }
    return overlaps;
}

/// The intensity that no tactor's limit minds. Who has no threshold minds any.
double harmless_intensity(const score::impl& s, const array& a)
{
    if (!s.unmeasured.empty())
        return 0.0;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < s.tactors.size(); ++i)
        least = std::min(least, tactor_limit(a, i) / std::abs(s.tactors[i].gain));
    return least * (1.0 - 1e-12); // for the rounding of the phantom
}

} // namespace

continuous_items::continuous_items(const score::impl& s, const array& a)
    : score_(s), harmless_(harmless_intensity(s, a)), overlaps_(overlapping(s))
{
}

bool continuous_items::have_bounds()
{
    const auto& items = score_.list.items;
    for (std::size_t i = 0; i < items.size(); ++i)
        if (items[i].kind == item_kind::continuous &&
            !std::all_of(most(i).begin(), most(i).end(), [](double b) { return std::isfinite(b); }))
            return false;
    return true;
}

/// At the carrier that needs most of each.
std::vector<double> continuous_items::at_levels(std::size_t number, std::vector<double> amplitudes) const
{
    const std::uint32_t plan = score_.list.items[number].plan;
    for (std::size_t i = 0; i < amplitudes.size(); ++i)
        amplitudes[i] *= std::abs(score_.tactors[i].gain) * score_.most_equalised(i, plan);
    return amplitudes;
}

const std::vector<double>& continuous_items::most(std::size_t number)
{
    const auto there = most_.find(number);
    if (there != most_.end())
        return there->second;
    const auto intensity =
        greatest_intensity(score_.plans[score_.list.items[number].plan].plan, score_.tactors.size());
    if (!intensity)
        return looked_at(number);
    return most_[number] = std::vector<double>(score_.tactors.size(), *intensity);
}

const std::vector<double>& continuous_items::looked_at(std::size_t number)
{
    const auto there = looked_at_.find(number);
    if (there != looked_at_.end())
        return there->second;
    const plan& p = score_.plans[score_.list.items[number].plan].plan;
    const std::size_t tactors = score_.tactors.size();
    // What is harmless alone may not be together with others.
    const bool equalised = !score_.measured.empty(); // harmless_ does not know of it
    return looked_at_[number] = overlaps_[number]
                                    ? continuous_peaks(p, tactors, 0.0, most_overlapping_points)
                                    : continuous_peaks(p, tactors, equalised ? 0.0 : harmless_, UINT64_MAX);
}

std::vector<double> continuous_items::bounds(std::size_t number)
{
    return at_levels(number, most(number));
}

std::vector<double> continuous_items::peaks(std::size_t number)
{
    return at_levels(number, looked_at(number));
}

} // namespace tactor::synth
