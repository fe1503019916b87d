// SPDX-License-Identifier: MIT
#include "study/calibrate/doubtful.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include <fmt/format.h>

namespace tactor::study {
namespace {

constexpr double most_above_median_db = 12.0;

std::optional<double> find_median(std::vector<double> v)
{
    if (v.empty())
        return {};
    std::sort(v.begin(), v.end());
    const std::size_t half = v.size() / 2;
    return v.size() % 2 != 0 ? v[half] : (v[half - 1] + v[half]) / 2.0;
}

} // namespace

std::vector<doubtful_threshold> find_doubtful(const array& a, const calibration_settings& s,
                                              const std::vector<tactor_threshold>& measured)
{
    std::vector<std::optional<double>> all;
    std::vector<double> felt;
    for (const tactor_spec& t : a.tactors)
        if (all.push_back(threshold_at(t, s.carrier_hz)); all.back())
            felt.push_back(*all.back());
    const double median = find_median(felt).value_or(0.0);
    std::vector<doubtful_threshold> doubtful;
    for (unsigned i = 0; i < all.size(); ++i) {
        const auto own = std::find_if(measured.begin(), measured.end(),
                                      [i](const tactor_threshold& t) { return t.tactor == i; });
        if (!all[i])
            continue;
        if (const double above = *all[i] - median; above > most_above_median_db)
            doubtful.push_back(
                {i, fmt::format("it is {:.1f} dB above the median of the array's ({:.1f} dBFS)", above,
                                median)});
        else if (own != measured.end() && own->check_below_right.value_or(0) >= too_many_below)
            doubtful.push_back({i, fmt::format("{} of {} answers 6 dB below it were right, after a second "
                                               "staircase too",
                                               *own->check_below_right, check_count)});
    }
    return doubtful;
}

} // namespace tactor::study
