// SPDX-License-Identifier: MIT
// Strokes as one actuator plays them, for a file of one vibration.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <tactor/error.hpp>

#include "core/start_times.hpp"
#include "core/trajectory/spans.hpp"
#include "core/vibration.hpp"
#include "files/vibration_file.hpp"

namespace tactor::detail {
namespace {

// Returns the carrier over the time of a stroke.
std::vector<timed_value> list_carriers(const stroke& k)
{
    std::vector<timed_value> all;
    for (const carrier_time& p : k.sound.carrier_times)
        all.push_back({p.t_s, p.hz});
    if (all.empty() && !k.sound.carrier_profile.empty()) {
        std::vector<double> parts;
        std::vector<timed_value> by_part;
        for (const carrier_part& p : k.sound.carrier_profile) {
            parts.push_back(p.part);
            by_part.push_back({p.part, p.hz});
        }
        for (const progress_point& p : find_smooth_progress(k.motion, parts).points)
            all.push_back({p.t_s, value_at(by_part, p.part, 0.0)});
    }
    if (all.empty())
        all.push_back({0.0, k.sound.carrier_hz.value_or(carrier_time{}.hz)});
    return all;
}

// Adds a touch to the last one if both have the same start.
void add_touch(std::vector<short_touch>& all, const short_touch& t)
{
    if (all.empty() || t.t_s - all.back().t_s > step_s) {
        all.push_back(t);
        return;
    }
    short_touch& with = all.back();
    const double sum = with.amplitude + t.amplitude;
    if (sum > 0.0)
        with.hz = (with.hz * with.amplitude + t.hz * t.amplitude) / sum;
    with.amplitude = sum;
    with.square += t.square;
    with.lasts_s = std::max(with.lasts_s, t.lasts_s);
}

} // namespace

void merge_steps(std::vector<double>& times)
{
    std::sort(times.begin(), times.end());
    std::vector<double> kept;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const bool step = i + 1 < times.size() && times[i + 1] - times[i] <= 1.1 * step_s;
        const bool near_first = !kept.empty() && kept.size() == 1 && times[i] - kept.front() <= step_s;
        if (kept.empty() || (!step && !near_first))
            kept.push_back(times[i]);
    }
    if (kept.size() == 1)
        kept.push_back(times.back()); // all of it is shorter than a step
    times = std::move(kept);
}

joined_strokes::joined_strokes(std::span<const stroke> strokes)
{
    start_times starts;
    for (const stroke& k : strokes) {
        const double from_s = starts.start(k.start_s, k.anchor);
        parts_.push_back({from_s, starts.set_duration(k.motion.duration_s()),
                          std::pow(10.0, k.choices.level_db / 20.0), &k, list_carriers(k)});
    }
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const part& a, const part& b) { return a.from_s < b.from_s; });
    const double origin_s = parts_.empty() ? 0.0 : std::min(parts_.front().from_s, 0.0);
    std::vector<part> longer;
    for (part& p : parts_) {
        p.from_s -= origin_s;
        p.to_s -= origin_s;
        duration_s_ = std::max(duration_s_, p.to_s);
        const std::vector<timed_point> points = sample_points(p.of->motion);
        if (p.of->motion.duration_s() <= longest_short_s) {
            const double intensity =
                std::max_element(points.begin(), points.end(), [](const auto& a, const auto& b) {
                    return a.intensity < b.intensity;
                })->intensity;
            const bool square = p.of->sound.wave && p.of->sound.wave->kind == waveform_kind::square;
            add_touch(touches_, {p.from_s, p.to_s - p.from_s, p.gain * intensity, p.hz.front().value,
                                 square ? p.gain * intensity : 0.0});
            continue;
        }
        knots_.insert(knots_.end(), {p.from_s, p.to_s});
        for (const timed_point& t : points)
            knots_.push_back(p.from_s + t.t_s);
        for (const timed_value& t : p.hz)
            if (p.from_s + t.t_s < p.to_s)
                knots_.push_back(p.from_s + t.t_s);
        longer.push_back(std::move(p));
    }
    parts_ = std::move(longer);
    knots_.insert(knots_.end(), {0.0, duration_s_});
    std::sort(knots_.begin(), knots_.end());
    std::size_t meetings = 0;
    for (const part& p : parts_)
        meetings += static_cast<std::size_t>(std::upper_bound(knots_.begin(), knots_.end(), p.to_s) -
                                             std::lower_bound(knots_.begin(), knots_.end(), p.from_s));
    if (meetings > most_meetings)
        throw error(error_kind::bad_input, "strokes", "too many overlap", "convert fewer strokes");
}

joined_strokes::sound joined_strokes::at(double t_s)
{
    constexpr double least = 1e-12; // keeps the frequency of a stroke that is silent for a while
    for (; next_ < parts_.size() && parts_[next_].from_s <= t_s; ++next_)
        active_.push_back(next_);
    std::erase_if(active_, [&](std::size_t i) { return parts_[i].to_s <= t_s; });
    sound s;
    double weights = 0.0;
    for (const std::size_t i : active_) {
        const part& p = parts_[i];
        const double own_s = t_s - p.from_s;
        const double amplitude = p.gain * p.of->motion.intensity(own_s);
        s.amplitude += amplitude;
        s.hz += (amplitude + least) * value_at(p.hz, own_s, 0.0);
        weights += amplitude + least;
        s.strokes += amplitude > 0.0 ? 1 : 0;
    }
    if (weights > 0.0)
        s.hz /= weights;
    return s;
}

} // namespace tactor::detail
