// SPDX-License-Identifier: MIT
/// \file
/// A simulated observer, and the length of a calibration with one. It tests the chain; it says nothing about
/// people.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/calibrate/calibration.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

struct observer_settings {
    std::vector<double> thresholds_dbfs = {}; ///< one for all, or one for each tactor that is measured
    double spread_db = 2.0;                   ///< 0: a step at the threshold
    double lapse = 0.0;                       ///< 0 to 0.5
    std::optional<std::uint64_t> seed = {};   ///< none: the session's
};

/// Reads "seed=1,threshold=-45,spread=2,lapse=0.02"; threshold=-45,-50,... is a list. `measured` are the
/// tactors that are measured, of `all` that the array has: a list has as many entries as the one or the
/// other. \throws error (bad_input) naming simulate.
observer_settings parse_observer(std::string_view text, const std::vector<unsigned>& measured,
                                 std::size_t all);

/// Returns the chance of a right answer: 0.5 + (0.5 - lapse) Phi((level - threshold) / spread).
double right_at(const observer_settings& o, double threshold_dbfs, double level_dbfs);

/// Answers trials in order. One that resumes must answer all of them again.
class observer {
public:
    observer(observer_settings o, const calibration_settings& s);

    calibration_answer answer(const calibration_trial& t);

private:
    double find_threshold(unsigned tactor) const;
    calibration_answer adjust(const calibration_trial& t);

    observer_settings o_;
    std::vector<unsigned> tactors_;
    random_numbers r_;
};

/// Returns "9 tactors, about 480 trials: some 30 minutes" for what is left of a calibration: what a simulated
/// observer needs, with time for the answers.
std::string time_text(const calibration& c);

} // namespace tactor::study
