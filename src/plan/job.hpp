// SPDX-License-Identifier: MIT
/// \file
/// The stroke that is being planned, and the parts that all algorithms share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// Number of the places in a plan that lie outside the triangle of their three tactors, which
/// faces_kind::nearest allows.
class missed_places {
public:
    /// Counts a burst, or a sample of a curve.
    void add(const layout& l, const burst& b);
    /// Returns the plan's warning; empty if there are none. `what` names a place: burst, sample.
    std::string warning(std::string_view what) const;

private:
    std::size_t all_ = 0;
    std::size_t missed_ = 0;
    std::size_t in_line_ = 0; ///< of these, places whose three tactors are in one line
    point first_ = {};
};

/// Counts over all bursts of a plan, for its warnings.
struct burst_count {
    std::size_t all = 0;
    std::size_t too_long = 0;  ///< too long for the timing law
    std::size_t too_short = 0; ///< too short for the carrier
    double longest_s = 0.0;
    double shortest_s = 0.0; ///< shortest of the too short bursts
    double first_s = 0.0;    ///< duration of the first burst
    missed_places missed = {};
};

/// Receiver of the next bursts of a plan; all of them end before any later burst. `so_far` has the other
/// members of the plan, such as carrier and phantom.
using burst_taker = std::function<void(const plan& so_far, std::span<const burst> next)>;

/// Input of the algorithms; lives as long as make_plan().
struct job {
    const array& tactors;
    const layout& faces;
    const stroke& motion;
    const plan_options& options;
    std::shared_ptr<const phantom_model> model;
    burst_count& counted;
    const burst_taker& take; ///< empty: all bursts stay in the plan
    mutable std::vector<drive> scratch =
        {}; ///< buffer for the drives of a burst, until their number is known

    /// Returns stroke "name", for messages.
    std::string name() const;
};

/// Plans a stroke as make_plan() does, and passes its bursts to `take` instead of storing them.
plan plan_in_pieces(const array& a, const layout& l, const stroke& s, const plan_options& common,
                    const burst_taker& take);

/// Counts the plan's bursts, and passes them to job::take if there is one.
void pass_on(const job& j, plan& p);

/// Returns the common options, overridden by those of a stroke.
plan_options apply_choices(plan_options common, const stroke_choices& c);

/// Solves Eq. (1) for the duration, with Eq. (11): a burst never outlasts its SOA. No check of bounds.
inline double law_duration_s(const timing_profile& p, double soa_s)
{
    return std::min((soa_s - p.intercept_s) / p.slope, soa_s);
}

/// Plan by an algorithm. Each fills in its own part of the plan.
void plan_park(const job& j, plan& out);
void plan_brush(const job& j, plan& out);
void plan_continuous(const job& j, plan& out);

/// Returns, for each burst of the Tactile Brush, its part before tau (Israr and Poupyrev 2011; rendering
/// model, section 5); nothing if the schedule is not possible. tau ascends from 0.
std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s);

/// Drops virtual tactors of the Tactile Brush, the one with the smallest gap first, until the schedule is
/// possible or only both ends remain. Returns the remaining places, ascending. O(n log n).
std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s);

/// Most bursts of a plan. More are a mistake in the input.
inline constexpr double most_bursts = 10e6;

/// Checks the number of bursts.
/// \throws error (bad_input) if there are too many.
void check_burst_count(const job& j, double bursts);

/// Returns the user's own model, or the named one. \throws error (bad_input) if it does not go with `faces`.
std::shared_ptr<const phantom_model> choose_model(const layout& l, const plan_options& o);
/// Returns the kind of faces that the algorithm uses.
faces_kind faces_used(const plan_options& o);

/// Computes drives by a model.
/// \throws error (bad_input) if a user's model breaks its contract.
void drives_at(const phantom_model& m, const layout& l, point p, double a_v, std::vector<drive>& out);

/// Returns a burst at a place with its drives; the intensity is the stroke's at t_s.
burst make_burst(const job& j, double onset_s, double duration_s, point p, double t_s);

/// Returns the times in which two or more bursts sound on one tactor, by time and then by tactor. `bursts`
/// are ordered by onset.
std::vector<conflict> find_conflicts(const std::vector<burst>& bursts);

/// Returns p, or the nearest point of the array if p is outside.
inline point held_in(const layout& l, point p)
{
    return l.contains(p) ? p : l.nearest(p);
}

/// Places along the stroke, kept in the array as plan_options::outside requires.
class follower {
public:
    explicit follower(const job& j) : job_(j) {}

    /// Returns the target's position, or with `clamp` the point of the hull nearest to it. With `error`, the
    /// times must not decrease from call to call.
    /// \throws error (bad_input) that names the place where the path leaves the array.
    point at(double t_s);

private:
    [[noreturn]] void refuse(double t_s) const;
    /// Returns the greatest distance of the target from the hull from `from_s` on, from 2000 places.
    double farthest_outside_mm(double from_s) const;

    const job& job_;
    double inside_s_ = -1.0; // the last time at which the target was inside
};

/// Returns plan::course of a stroke that is played with a waveform.
std::vector<carrier_point> make_course(const stroke& s, const waveform& w);

/// Returns the frequency between two points of a course, at a part of their time, 0 to 1.
double hz_between(const carrier_point& from, const carrier_point& to, double u);

/// Returns the carrier at a part of the path; the profile has points. O(log n).
double hz_at(const std::vector<carrier_part>& profile, double part);

/// Returns a time in seconds for a message, rounded up to a nanosecond: "1.2345".
std::string seconds_up(double t_s);
/// Returns a time in seconds, rounded down.
std::string seconds_down(double t_s);

/// Returns "(40.000, 0.000) mm".
std::string place(point p);

} // namespace tactor::detail
