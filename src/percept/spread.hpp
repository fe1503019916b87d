// SPDX-License-Identifier: MIT
/// \file
/// Differences between people: the same plans felt by many randomly drawn people, and intervals of what they
/// feel.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Number of drawn people, and ranges of their differences, which are evenly distributed.
struct spread_choice {
    unsigned people = 0; ///< 0: none
    std::uint64_t seed = 1;
    double sigma_factor = 2.0; ///< factor on sigma of low_speed, from 1 / this to this, evenly by ratio
    double threshold_db = 6.0; ///< each tactor's threshold, plus or minus
    double place_mm = 2.0;     ///< each tactor's place, anywhere within this distance
};

/// Returns a sentence about the ranges.
std::string spread_note(const spread_choice& c, bool by_taps);

/// A drawn person.
struct drawn_person {
    tactor::person who;
    double sigma_factor = 1.0;
};

/// Draws people: equal for the same seed and number of tactors.
std::vector<drawn_person> draw_people(const spread_choice& c, std::size_t tactors);

/// Range between 5 and 95 % of the people.
struct interval {
    double low = 0.0;
    double high = 0.0;
};

/// Band of a speed chart at one time.
struct speed_range {
    double t_s = 0.0;
    double low = 0.0;
    double high = 0.0;
};

/// Intervals of a row's figures; none for figures that its observer does not give.
struct row_spread {
    std::optional<interval> rms_error_mm = {};
    std::optional<interval> largest_error_mm = {};
    std::optional<interval> speed_cv = {};
    std::optional<interval> intensity_cv = {};
    std::optional<interval> felt_length_mm = {};
    std::optional<interval> length_ratio = {};
    std::vector<speed_range> speeds = {};        ///< only for a picture
    std::vector<std::vector<point>> tracks = {}; ///< of the first people, only for a picture
};

/// Predicts what each person feels of a plan: as the low-speed observer, or else by the centroid. Calls
/// `after_person` after each.
row_spread predict_spread(const std::vector<drawn_person>& people, const array& a, const stroke& s,
                          const plan& p, const std::optional<low_speed_observer>& low_speed, bool for_picture,
                          const std::function<void()>& after_person);

} // namespace tactor::detail
