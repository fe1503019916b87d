// SPDX-License-Identifier: MIT
/// \file
/// Planning: from an array and a stroke to the schedule of bursts. Pure functions of their arguments.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/phantom.hpp>
#include <tactor/stroke.hpp>

namespace tactor {

/// SOA = slope * duration + intercept: Eq. (1) of Park et al. 2016, from Israr and Poupyrev 2011.
/// Both depend on the body site.
struct timing_profile {
    double slope = 0.32;
    double intercept_s = 0.0473;
    double max_soa_s = 0.07; ///< Eq. (11), as the paper rounds it: intercept / (1 - slope)
};

enum class algorithm { park2016, tactile_brush, continuous };
enum class timing { fixed, fit };
enum class outside { error, clamp };
/// How bursts that overlap on one tactor are joined into one carrier's amplitude.
enum class overlap { energy, max, sum };

TACTOR_API std::string_view to_string(algorithm a) noexcept;
TACTOR_API std::string_view to_string(timing t) noexcept;
TACTOR_API std::string_view to_string(outside o) noexcept;
TACTOR_API std::string_view to_string(overlap o) noexcept;

struct plan_options {
    algorithm method = algorithm::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    /// A model of your own instead of `phantom`; it must outlive nothing, the plan shares it.
    std::shared_ptr<const phantom_model> custom_phantom = {};
    timing_profile profile = {};
    double soa_s = 0.07; ///< intercept < soa <= max_soa (with burst_s up to 10); for `fit` the longest one
    /// Duration of each burst of park2016 instead of the law's, 0.0001 to soa_s. The plan warns where the two
    /// leave the law. The other algorithms warn that they do not use it.
    std::optional<double> burst_s = {};
    timing schedule = timing::fixed;
    double min_duration_s = 0.020; ///< shortest burst that `fit` may use
    outside leave = outside::error;
    bool snap = false;        ///< Tactile Brush: move a start or end onto the grid
    bool drop_points = false; ///< Tactile Brush: leave crossings out until the timing is possible
    overlap join = overlap::energy;
    double carrier_hz = 250.0;
};

/// Tactors that sound together from `onset_s` for `duration_s`.
struct burst {
    double onset_s = 0.0;
    double duration_s = 0.0;
    point position = {};
    double intensity = 1.0;           ///< A_v
    std::optional<double> tau_s = {}; ///< Tactile Brush: when the target is at `position`
    std::vector<drive> drives = {};   ///< in order of tactor
};

/// Two or more bursts on one tactor at once.
struct conflict {
    unsigned tactor = 0;
    double from_s = 0.0;
    double to_s = 0.0;
};

/// Who plays, when and how strongly. A value: the same input gives the same plan.
struct plan {
    std::string algorithm = {};
    std::string phantom = {};
    double stroke_duration_s = 0.0;
    double stroke_length_mm = 0.0;
    double carrier_hz = 250.0;
    overlap join = overlap::energy;
    std::optional<double> soa_s = {}; ///< none where bursts have no common SOA
    double total_s = 0.0;             ///< end of the last sound
    std::vector<burst> bursts = {};   ///< by onset; empty for `continuous`
    std::vector<conflict> conflicts = {};
    std::vector<meeting> dropped = {};
    std::vector<std::string> warnings = {};

    /// `continuous` only: position, intensity and drives at a time in 0 ... stroke_duration_s, as a
    /// burst without duration. Replaces `out`. Where it throws, or gives an amplitude that is not finite,
    /// the stroke ends as interrupted. Empty for plans of bursts.
    std::function<void(double t_s, burst& out)> at = {};
};

/// Interval at which `continuous` evaluates the phantom; linear between.
inline constexpr double continuous_step_s = 0.001;

/// Plans one stroke on an array. `l` must be the layout of `a`.
/// O(log n) in the tactors for each burst.
/// \throws error (bad_input): SOA out of bounds, path outside the array (where it leaves it), timing
///         that cannot be done (the nearest duration that can), no grid for Tactile Brush.
TACTOR_API plan make_plan(const array& a, const layout& l, const stroke& s, const plan_options& o);

/// The same, for one stroke only: builds the layout itself.
TACTOR_API plan make_plan(const array& a, const stroke& s, const plan_options& o = {});

/// Burst duration for an SOA: min((SOA - intercept) / slope, SOA). \throws error (bad_input) unless
/// intercept < soa <= max_soa; the message names both bounds.
TACTOR_API double burst_duration_s(const timing_profile& p, double soa_s);

/// Duration of the bursts of park2016: burst_s if it is given, else the law's. \throws error (bad_input) as
/// above, or for a burst that is longer than the SOA or shorter than 0.1 ms.
TACTOR_API double burst_duration_s(const plan_options& o);

} // namespace tactor
