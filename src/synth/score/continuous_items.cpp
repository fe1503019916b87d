// SPDX-License-Identifier: MIT
#include "synth/score/continuous_items.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>

#include "synth/score/continuous_peaks.hpp"
#include "synth/score/levels.hpp"

namespace tactor::synth {

namespace {

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
    const auto intensity = greatest_intensity(score_.plans[score_.list.items[number].plan].schedule);
    if (!intensity)
        return looked_at(number);
    return most_[number] = std::vector<double>(score_.tactors.size(), *intensity);
}

const std::vector<double>& continuous_items::looked_at(std::size_t number)
{
    const auto there = looked_at_.find(number);
    if (there != looked_at_.end())
        return there->second;
    const plan& p = score_.plans[score_.list.items[number].plan].schedule;
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

std::vector<std::vector<double>> continuous_items::promised()
{
    std::vector<std::vector<double>> all(score_.plans.size());
    const auto& items = score_.list.items;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (items[i].kind == item_kind::continuous) {
            const auto looked = looked_at_.find(i);
            all[items[i].plan] = looked != looked_at_.end() ? looked->second : most(i);
        }
    }
    return all;
}

} // namespace tactor::synth
