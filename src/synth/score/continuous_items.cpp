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
std::vector<bool> overlapping(const item_list& list)
{
    const std::deque<item>& items = list.items;
    std::vector<bool> overlaps(items.size(), false);
    std::uint64_t end = 0; // of those before
    std::size_t longest = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const item& it = items[i];
        if (it.kind == item_kind::marker) {
            continue;
        }
        if (list.heard_from(it) < end) {
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

/// The intensity that no tactor's limit minds.
double harmless_intensity(const score::impl& s, const array& a)
{
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < s.tactors.size(); ++i) {
        least = std::min(least, tactor_limit(a, i) / std::abs(s.tactors[i].gain));
    }
    return least * (1.0 - 1e-12); // for the rounding of the phantom
}

} // namespace

continuous_items::continuous_items(const score::impl& s, const array& a)
    : score_(s), harmless_(harmless_intensity(s, a)), overlaps_(overlapping(s.list))
{
}

bool continuous_items::have_bounds()
{
    const auto& items = score_.list.items;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (items[i].kind == item_kind::continuous &&
            !std::all_of(bounds(i).begin(), bounds(i).end(), [](double b) { return std::isfinite(b); })) {
            return false;
        }
    }
    return true;
}

/// At the carrier that needs most of each.
std::vector<tactor_level> continuous_items::levels(std::uint32_t plan) const
{
    std::vector<tactor_level> all = score_.tactors;
    for (std::size_t i = 0; i < all.size() && !score_.measured.empty(); ++i) {
        all[i].gain *= score_.most_equalised(i, plan);
    }
    return all;
}

const std::vector<double>& continuous_items::bounds(std::size_t number)
{
    const auto there = bounds_.find(number);
    if (there != bounds_.end()) {
        return there->second;
    }
    const auto intensity = greatest_intensity(score_.plans[score_.list.items[number].plan].schedule);
    if (!intensity) {
        return peaks(number);
    }
    std::vector<double>& bounds = bounds_[number];
    for (const tactor_level& t : levels(score_.list.items[number].plan)) {
        bounds.push_back(std::abs(*intensity * t.gain));
    }
    return bounds;
}

const std::vector<double>& continuous_items::peaks(std::size_t number)
{
    const auto there = peaks_.find(number);
    if (there != peaks_.end()) {
        return there->second;
    }
    const plan& p = score_.plans[score_.list.items[number].plan].schedule;
    // What is harmless alone may not be together with others.
    const bool equalised = !score_.measured.empty(); // harmless_ does not know of it
    const std::vector<tactor_level> tactors = levels(score_.list.items[number].plan);
    return peaks_[number] = overlaps_[number]
                                ? continuous_peaks(p, tactors, 0.0, most_overlapping_points)
                                : continuous_peaks(p, tactors, equalised ? 0.0 : harmless_, UINT64_MAX);
}

} // namespace tactor::synth
