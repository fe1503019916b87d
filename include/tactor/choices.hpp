// SPDX-License-Identifier: MIT
/// \file
/// Options with a closed set of values, for plans, sound and observers. Also the options that a single stroke
/// may set: how the stroke is planned and when it starts.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// Planning algorithms.
enum class algorithm_kind { park2016, tactile_brush, continuous };
TACTOR_KIND(algorithm_kind);

/// Built-in phantom models.
enum class phantom_kind {
    inverse_distance, ///< Park et al. 2016, Eqs. (2) and (10)
    barycentric,      ///< sqrt of barycentric coordinates: equal energy, continuous, no centroid error
    linear,           ///< barycentric coordinates as amplitudes
    log,              ///< log2(1 + b)
    gaussian,         ///< all nearby tactors, exp(-d^2 / (2 (0.6 pitch)^2)), equal energy
};
TACTOR_KIND(phantom_kind);

/// The three tactors that phantom_kind::inverse_distance uses.
enum class faces_kind {
    delaunay, ///< three corners of the Delaunay face at the point; their triangle contains the point
    nearest,  ///< the three tactors nearest to the point, as in Park et al. 2016; the point may lie outside
              ///< their triangle
};
TACTOR_KIND(faces_kind);

/// Treatment of the SOA: used as given, or shortened so that the last burst ends with the path.
enum class timing_kind { fixed, fit };
TACTOR_KIND(timing_kind);

/// Treatment of a path that leaves the array: refused, or moved to the edge.
enum class outside_kind { error, clamp };
TACTOR_KIND(outside_kind);

/// Rule that computes a single amplitude where bursts overlap on one tactor.
enum class overlap_kind { energy, max, sum };
TACTOR_KIND(overlap_kind);

/// Meaning of an intensity of one half: half the amplitude (linear), half the sensation level in dB (sl), or
/// half the felt strength by Stevens's law (stevens).
enum class scale_kind { linear, sl, stevens };
TACTOR_KIND(scale_kind);

/// Start of the carrier's phase. `stroke`: one carrier runs from the stroke's first frame, and bursts switch
/// it on and off. A tactor that plays several bursts in a row vibrates without a break. `burst`: the carrier
/// starts again with each burst. Where bursts overlap on a tactor, it starts with the first of them. A burst
/// of 70 ms at 250 Hz has 17.5 cycles, so the sign of the vibration flips from burst to burst. Its spectrum
/// then has lines at 242.9 and 257.1 Hz instead of 250 Hz, and its mean is above 0.
enum class phase_kind { stroke, burst };
TACTOR_KIND(phase_kind);

/// Treatment of a score whose strokes or bursts together exceed the requested level on a tactor.
enum class together_kind {
    weaken, ///< weakens the whole score by one factor, so that the loudest tactor just reaches the requested
            ///< level
    sum,    ///< adds strokes and bursts up, limited by the tactor's max_dbfs and full scale
};
TACTOR_KIND(together_kind);

/// Model of the person who feels a plan.
enum class observer_kind {
    centroid,  ///< feels the centre of energy of the tactors that sound
    low_speed, ///< expects low speeds
};
TACTOR_KIND(observer_kind);

/// Values of one stroke that replace those of plan_options. `phantom` also replaces
/// plan_options::custom_phantom.
struct stroke_choices {
    std::optional<algorithm_kind> algorithm = {};
    std::optional<phantom_kind> phantom = {};
    std::optional<double> soa_s = {};
    std::optional<double> burst_s = {};
    double level_db = 0.0; ///< added to the stroke's amplitudes after plan_options::scale, dB, 0 or less
    std::optional<faces_kind> faces = {};

    friend bool operator==(const stroke_choices&, const stroke_choices&) = default;
};

/// Time from which a start counts.
enum class start_from_kind {
    piece, ///< the start of the score
    start, ///< the start of an earlier stroke
    end,   ///< the end of earlier strokes
};
TACTOR_KIND(start_from_kind);

/// Reference time of a stroke's start. If fewer than `back` strokes come before the stroke, its start counts
/// from the start of the score.
struct start_anchor {
    start_from_kind from = start_from_kind::piece;
    /// Number of strokes. With `start`, the time counts from the start of the stroke that is `back` places
    /// before this stroke. With `end`, it counts from the time when the last `back` strokes before this
    /// stroke have all ended.
    unsigned back = 1;

    friend bool operator==(const start_anchor&, const start_anchor&) = default;
};

/// Returns the start of a stroke in seconds from the start of the score. `starts_s` and `ends_s` are the
/// starts and ends of the strokes before it, in order. Without `start_s` the stroke starts when the stroke
/// before it ends.
/// \throws error (bad_input) if the stroke would start before the score.
[[nodiscard]] TACTOR_API double resolve_start_s(std::optional<double> start_s, const start_anchor& anchor,
                                                std::span<const double> starts_s,
                                                std::span<const double> ends_s);

/// Formats of a sample. Names: "float", "s16", "s24" (s24_3), "s24-4", "s32".
enum class format_kind {
    float32, ///< FLOAT_LE, full scale 1.0
    s16,     ///< S16_LE
    s24_3,   ///< S24_3LE: packed in three bytes, as in WAV files
    s24_4,   ///< S24_LE: right-aligned in four bytes
    s32,     ///< S32_LE
};

/// Returns the number of bytes of one sample.
[[nodiscard]] TACTOR_API std::size_t sample_bytes(format_kind f) noexcept;

TACTOR_KIND(format_kind);

} // namespace v0
} // namespace tactor
