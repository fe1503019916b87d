// SPDX-License-Identifier: MIT
/// \file
/// Planning: from an array and a stroke to a plan, which says when each tactor plays. Pure functions of their
/// arguments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/path.hpp>
#include <tactor/phantom.hpp>
#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// SOA = slope * duration + intercept: Eq. (1) of Park et al. 2016, from Israr and Poupyrev 2011.
/// Both depend on the body site.
struct timing_profile {
    double slope = 0.32;
    double intercept_s = 0.0473;
    double max_soa_s = 0.07; ///< Eq. (11), as the paper rounds it: intercept / (1 - slope)
};

/// From the intensity that is asked for to an amplitude; 0 and 1 stay.
struct intensity_scale {
    scale_kind kind = scale_kind::linear;
    /// stevens: felt = amplitude^exponent, so that the amplitude is intensity^(1 / exponent). 0.1 to 3. On
    /// the finger 0.95 at 60 Hz and 0.6 at 250 Hz (Stevens, Perception & Psychophysics 3, 1968).
    double exponent = 0.6;
    double sl_db = 0.0; ///< sl: the sensation level of intensity 1, dB, above 0
    /// Added to the amplitudes; then 1 does not stay. A stroke's own level (stroke_choices) comes on top.
    double level_db = 0.0;

    /// \throws error (bad_input) for what is out of range.
    [[nodiscard]] TACTOR_API double amplitude(double intensity) const;

    friend bool operator==(const intensity_scale&, const intensity_scale&) = default;
};

struct plan_options {
    algorithm_kind algorithm = algorithm_kind::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    /// `nearest` goes with phantom_kind::inverse_distance alone, and the plan warns where the triangle of the
    /// three misses the point. Tactile Brush plays on grid lines and warns that it does not use it.
    faces_kind faces = faces_kind::delaunay;
    /// A model of your own instead of `phantom`; kept as long as it is asked for drives.
    std::shared_ptr<const phantom_model> custom_phantom = {};
    timing_profile profile = {};
    double soa_s = 0.07; ///< intercept < soa <= max_soa (with burst_s up to 10); for `fit` the longest one
    /// Duration of each burst of park2016 instead of the law's, 0.0001 to soa_s. The plan warns where the two
    /// leave the law. The other algorithms warn that they do not use it.
    std::optional<double> burst_s = {};
    timing_kind timing = timing_kind::fixed;
    double min_duration_s = 0.020; ///< shortest burst that `fit` may use
    outside_kind outside = outside_kind::error;
    bool snap = false;        ///< Tactile Brush: move a start or end onto the grid
    bool drop_points = false; ///< Tactile Brush: leave crossings out until the timing is possible
    overlap_kind overlap = overlap_kind::energy;
    double carrier_hz = 250.0;
    waveform wave = {};
    modulation am = {};
    intensity_scale scale = {};
};

/// Tactors that sound together from `onset_s` for `duration_s`.
struct burst {
    double onset_s = 0.0;
    double duration_s = 0.0;
    point position = {};
    double intensity = 1.0;           ///< A_v, as plan_options::scale gives it
    std::optional<double> tau_s = {}; ///< Tactile Brush: when the target is at `position`
    std::vector<drive> drives = {};   ///< in order of tactor

    friend bool operator==(const burst&, const burst&) = default;
};

/// Two or more bursts on one tactor at once.
struct conflict {
    unsigned tactor = 0;
    double from_s = 0.0;
    double to_s = 0.0;

    friend bool operator==(const conflict&, const conflict&) = default;
};

/// The frequency of a carrier at a time, and until the next point: with u from 0 to 1 between their times,
/// and from hz to the next one's, hz + u (next - hz) + u (1 - u) (bend[0] + bend[1] u + bend[2] u^2 + bend[3]
/// u^3).
struct carrier_point {
    double t_s = 0.0;                ///< from the beginning of the carrier
    double hz = 0.0;                 ///< >= 0
    std::array<double, 4> bend = {}; ///< Hz; zeros: linear

    friend bool operator==(const carrier_point&, const carrier_point&) = default;
};

/// Interval at which `continuous` evaluates the phantom; linear between.
inline constexpr double continuous_step_s = 0.001;

/// Samples by column, in order of time. A plain value.
struct curve_samples {
    std::vector<point> positions = {};
    std::vector<double> intensities = {}; ///< A_v, as plan_options::scale gives it
    std::vector<std::size_t> ends = {};   ///< by sample: how many of `drives` it and earlier ones have
    std::vector<drive> drives = {};       ///< each sample's in order of tactor

    /// Appends position, intensity and drives of `b`.
    TACTOR_API void add(const burst& b);

    friend bool operator==(const curve_samples&, const curve_samples&) = default;
};

/// Position, intensity and drives of a continuous stroke every continuous_step_s, and at its end; linear
/// between. A value: two are equal where all their samples are. Copies and moves share the samples, and a
/// curve that was moved from keeps its value; any thread may call. make_plan() stores the samples of short
/// strokes. For a stroke of more than some seconds they are computed when they are read: an hour needs no
/// more memory.
class TACTOR_API curve {
public:
    /// `samples`: ceil(duration_s / continuous_step_s) + 1 of them.
    /// \throws error (bad_input): a duration that is not above 0 or beyond a day, another number of samples,
    ///         drives that are not in order of tactor, numbers that are not finite.
    curve(double duration_s, curve_samples samples);
    curve(const curve&) noexcept = default;
    curve& operator=(const curve&) noexcept = default;

    [[nodiscard]] double duration_s() const noexcept;
    /// Number of samples.
    [[nodiscard]] std::uint64_t size() const noexcept;
    /// Time of sample k: k steps, at most the duration.
    [[nodiscard]] double time_s(std::uint64_t k) const noexcept;

    /// Replaces `out` by sample k (the last one, where there are not so many) as a burst without duration.
    void sample(std::uint64_t k, burst& out) const;
    /// The same at a time, clamped to 0 ... duration_s: linear between the samples next to it.
    void at(double t_s, burst& out) const;

    friend TACTOR_API bool operator==(const curve& a, const curve& b);

    struct impl;

private:
    friend struct curve_access;
    explicit curve(std::shared_ptr<const impl> p) noexcept;

    std::shared_ptr<const impl> impl_;
};

/// Which tactors play, when and how strongly: bursts or a curve. A value: the same input gives the same plan,
/// and its contents can be compared, stored and made again.
struct plan {
    std::string algorithm = {}; ///< the planner's name: of an algorithm_kind, or your own
    std::string phantom = {};
    faces_kind faces = faces_kind::delaunay;
    double stroke_duration_s = 0.0;
    double stroke_length_mm = 0.0;
    double carrier_hz = 250.0;
    overlap_kind overlap = overlap_kind::energy;
    std::optional<double> soa_s = {};        ///< none where bursts have no common SOA
    double total_s = 0.0;                    ///< end of the last sound
    std::vector<burst> bursts = {};          ///< by onset; empty for `continuous`
    std::optional<tactor::curve> curve = {}; ///< `continuous` only
    std::vector<conflict> conflicts = {};
    std::vector<meeting> dropped = {};
    std::vector<std::string> warnings = {};
    waveform wave = {};
    modulation am = {};
    /// The frequency over time, linear between points, in order of time. None: carrier_hz all along. For a
    /// recording that lies along the path, how often it is repeated.
    std::vector<carrier_point> course = {};

    friend bool operator==(const plan&, const plan&) = default;
};

/// Plans one stroke on an array. `l` must be the layout of `a`. The stroke's own choices (stroke::choices)
/// win over `o`. A stroke with a stroke::fit is fitted first. O(log n) in the tactors for each burst.
/// \throws error (bad_input): SOA out of bounds, path outside the array (with the place where it leaves it),
///         timing that is not possible (with the nearest duration that is), no grid for Tactile Brush.
[[nodiscard]] TACTOR_API plan make_plan(const array& a, const layout& l, const stroke& s,
                                        const plan_options& o);

/// The same, for one stroke only: builds the layout itself.
[[nodiscard]] TACTOR_API plan make_plan(const array& a, const stroke& s, const plan_options& o = {});

/// Burst duration for an SOA: min((SOA - intercept) / slope, SOA). \throws error (bad_input) unless
/// intercept < soa <= max_soa; the message names both bounds.
[[nodiscard]] TACTOR_API double burst_duration_s(const timing_profile& p, double soa_s);

/// Duration of the bursts of park2016: burst_s if it is given, else the law's. \throws error (bad_input) as
/// above, or for a burst that is longer than the SOA or shorter than 0.1 ms.
[[nodiscard]] TACTOR_API double burst_duration_s(const plan_options& o);

} // namespace v0
} // namespace tactor
