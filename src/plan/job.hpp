// SPDX-License-Identifier: MIT
/// \file
/// The stroke that is being planned, and functions that all algorithms share.
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

/// Counter of places in a plan that lie outside the triangle of the three tactors that play them.
/// faces_kind::nearest allows such places.
class missed_places {
public:
    /// Counts a burst, or a sample of a curve.
    void add(const layout& l, const burst& b);
    /// Returns the warning about missed places; empty if there are none. `what`: name for a place, "burst" or
    /// "sample".
    std::string warning(std::string_view what) const;

private:
    std::size_t all_ = 0;
    std::size_t missed_ = 0;
    std::size_t in_line_ = 0; ///< missed places whose three tactors are in one line
    point first_ = {};
};

/// Counts over all bursts of a plan, for its warnings.
struct burst_count {
    std::size_t all = 0;
    std::size_t too_long = 0;  ///< number of bursts too long for the timing law
    std::size_t too_short = 0; ///< number of bursts too short for the carrier
    double longest_s = 0.0;
    double shortest_s = 0.0; ///< shortest of the too short bursts
    double first_s = 0.0;    ///< duration of the first burst
    missed_places missed = {};
};

/// Receiver of the next bursts of a plan. They all end before the bursts of later calls begin. `so_far` has
/// the other members of the plan, such as carrier and phantom.
using burst_taker = std::function<void(const plan& so_far, std::span<const burst> next)>;

/// Input of the algorithms. It lives as long as make_plan() runs.
struct job {
    const array& tactors;
    const layout& faces;
    const stroke& motion;
    const plan_options& options;
    std::shared_ptr<const phantom_model> model;
    burst_count& counted;
    const burst_taker& take; ///< if empty, all bursts stay in the plan
    mutable std::vector<drive> scratch =
        {}; ///< buffer for the drives of a burst, until their number is known

    /// Returns a text such as stroke "circle", for messages.
    std::string name() const;
};

/// Plans a stroke as make_plan() does, but passes the bursts to `take` instead of storing them.
plan plan_in_pieces(const array& a, const layout& l, const stroke& s, const plan_options& common,
                    const burst_taker& take);

/// Counts the plan's bursts. If job::take is not empty, passes the bursts to it, and removes them.
void deliver_bursts(const job& j, plan& p);

/// Returns the common options, overridden by the options that a stroke sets.
plan_options apply_choices(plan_options common, const stroke_choices& c);

/// Solves Eq. (1) for the duration, limited by Eq. (11): a burst is never longer than the SOA. Does not check
/// bounds.
inline double law_duration_s(const timing_profile& p, double soa_s)
{
    return std::min((soa_s - p.intercept_s) / p.slope, soa_s);
}

/// Plan by an algorithm. Each function fills in the members of the plan that depend on the algorithm.
void plan_park(const job& j, plan& out);
void plan_brush(const job& j, plan& out);
void plan_continuous(const job& j, plan& out);

/// Returns the part of each burst of the Tactile Brush that lies before tau, s (Israr and Poupyrev 2011;
/// rendering model, section 5). Empty if the schedule is not possible. `tau_s` must ascend from 0.
std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s);

/// Drops virtual tactors of the Tactile Brush, the tactor with the smallest gap first, until the schedule is
/// possible or only the two ends remain. Returns the indices of the remaining tactors, ascending. O(n log n).
std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s);

/// Greatest number of bursts of a plan. More bursts mean a mistake in the input.
inline constexpr double most_bursts = 10e6;

/// Checks the number of bursts.
/// \throws error (bad_input) if there are too many.
void check_burst_count(const job& j, double bursts);

/// Returns the user's own phantom model, or the model that the options name. \throws error (bad_input) if the
/// model does not work with the option `faces`.
std::shared_ptr<const phantom_model> choose_model(const layout& l, const plan_options& o);
/// Returns the kind of faces that the algorithm uses.
faces_kind effective_faces(const plan_options& o);

/// Computes drives by a model.
/// \throws error (bad_input) if a user's model breaks its contract.
void compute_drives(const phantom_model& m, const layout& l, point p, double a_v, std::vector<drive>& out);

/// Returns a burst at a place, with drives. The intensity is the intensity of the stroke at t_s.
burst make_burst(const job& j, double onset_s, double duration_s, point p, double t_s);

/// Returns the times in which two or more bursts sound on one tactor, ordered by time and then by tactor.
/// `bursts` must be ordered by onset.
std::vector<conflict> find_conflicts(const std::vector<burst>& bursts);

/// Returns p, or the nearest point of the array if p is outside.
inline point clamp_to_array(const layout& l, point p)
{
    return l.contains(p) ? p : l.nearest(p);
}

/// Places along the stroke, kept in the array as plan_options::outside requires.
class follower {
public:
    explicit follower(const job& j) : job_(j) {}

    /// Returns the target's position, or the nearest point of the hull if the target is outside. With
    /// outside_kind::error, times must not decrease from call to call.
    /// \throws error (bad_input) with outside_kind::error if the path leaves the array. The error names the
    ///         place.
    point at(double t_s);

private:
    [[noreturn]] void refuse(double t_s) const;
    /// Returns the greatest distance of the target from the hull after `from_s`. Checks some 2000 places.
    double farthest_outside_mm(double from_s) const;

    const job& job_;
    double inside_s_ = -1.0; // the last time at which the target was inside
};

/// Returns plan::course of a stroke that is played with a waveform.
std::vector<carrier_point> make_course(const stroke& s, const waveform& w);

/// Returns the frequency between two points of a course. `u`: part of the time between them, 0 to 1.
double hz_between(const carrier_point& from, const carrier_point& to, double u);

/// Returns the carrier at a part of the path, 0 to 1. The profile must have points. O(log n).
double hz_at(const std::vector<carrier_part>& profile, double part);

/// Returns a time in seconds for a message, such as "1.2345", rounded up to a nanosecond.
std::string format_seconds_up(double t_s);
/// Returns a time in seconds for a message, rounded down to a nanosecond.
std::string format_seconds_down(double t_s);

/// Returns a text such as "(40.000, 0.000) mm".
std::string place(point p);

} // namespace tactor::detail
