// SPDX-License-Identifier: MIT
#include "study/calibrate/calibration_time.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/calibrate/observer.hpp"

namespace tactor::study {
namespace {

constexpr double answer_s = 1.5; // and the half second before the first interval
constexpr double before_s = 0.5;
constexpr double series_s = 20.0; // of an adjustment

} // namespace

std::string time_text(const calibration& c)
{
    const calibration_settings& s = c.settings();
    calibration left = c;
    observer typical({.thresholds_dbfs = {-45.0}}, s);
    const double trial_s = before_s + 2.0 * s.interval_s + interval_gap_s + answer_s;
    double seconds = 0.0;
    std::size_t trials = 0;
    std::set<unsigned> tactors;
    for (; !left.done(); ++trials) {
        const calibration_trial t = left.next();
        tactors.insert(t.tactor);
        seconds += t.interval != 0 ? trial_s : series_s;
        static_cast<void>(left.answer(typical.answer(t)));
    }
    const auto minutes = static_cast<std::uint64_t>(std::max(1.0, std::round(seconds / 60.0)));
    return fmt::format("{}, about {}: some {}", counted(tactors.size(), "tactor"), counted(trials, "trial"),
                       counted(minutes, "minute"));
}

} // namespace tactor::study
