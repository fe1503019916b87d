// SPDX-License-Identifier: MIT
#include <tactor/percept.hpp>

#include <fmt/format.h>

#include <tactor/words.hpp>

#include "plan/numbers.hpp"
#include "plan/percept_sounding.hpp"

namespace tactor {
namespace {

constexpr std::size_t half_window = 50;
static_assert(percept_window_s == 2 * half_window * percept_step_s);

std::size_t count_samples(double duration_s)
{
    if (!(duration_s <= longest_percept_s))
        throw error(errc::bad_input, "stroke",
                    fmt::format("lasts {}, too long to predict what is felt", seconds_text(duration_s)),
                    fmt::format("at most {} s", longest_percept_s));
    return static_cast<std::size_t>((duration_s + detail::same_time_s) / percept_step_s) + 1;
}

/// Sums of the positions felt, from the first on: sums[i] of the first i. Where nothing is felt, the last
/// position is held. Relative to the first one, for the sake of precision.
std::vector<point> running_sums(const std::vector<percept_sample>& samples, std::size_t first)
{
    std::vector<point> sums{{}};
    sums.reserve(samples.size() - first + 1);
    const point origin = *samples[first].felt;
    point held = origin;
    for (std::size_t i = first; i < samples.size(); ++i) {
        held = samples[i].felt.value_or(held);
        sums.push_back(
            {sums.back().x_mm + (held.x_mm - origin.x_mm), sums.back().y_mm + (held.y_mm - origin.y_mm)});
    }
    return sums;
}

void add_speeds(std::vector<percept_sample>& samples)
{
    std::size_t first = 0;
    while (first < samples.size() && !samples[first].felt)
        ++first;
    if (first == samples.size())
        return;
    const std::vector<point> sums = running_sums(samples, first);
    constexpr std::size_t width = 2 * half_window + 1;
    const auto average = [&](std::size_t i) { // counted from the first one felt
        const point& before = sums[i - half_window];
        const point& after = sums[i + half_window + 1];
        return point{(after.x_mm - before.x_mm) / width, (after.y_mm - before.y_mm) / width};
    };
    for (std::size_t i = half_window + 1; i + half_window + 2 < sums.size(); ++i)
        samples[first + i].speed_mm_s = distance_mm(average(i + 1), average(i - 1)) / (2.0 * percept_step_s);
}

} // namespace

std::vector<percept_sample> predict_percept(const array& a, const stroke& s, const plan& p)
{
    std::vector<percept_sample> samples(count_samples(s.motion.duration_s()));
    detail::sounding now(a, p, s.motion.duration_s());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        percept_sample& x = samples[i];
        x.t_s = static_cast<double>(i) * percept_step_s;
        x.target = s.motion.position(x.t_s);
        x.target_intensity = s.motion.intensity(x.t_s);
        now.at(x.t_s, x);
    }
    add_speeds(samples);
    return samples;
}

} // namespace tactor
