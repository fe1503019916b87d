// SPDX-License-Identifier: MIT
/// \file
/// The closed sets that plans, their sound and their observers are chosen from; what a stroke may say of
/// itself beside its movement: how it is planned, and from when its start counts.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

enum class algorithm_kind { park2016, tactile_brush, continuous };
TACTOR_KIND(algorithm_kind);

/// Built-in phantom models.
enum class phantom_kind {
    inverse_distance, ///< Park et al. 2016, Eqs. (2) and (10)
    barycentric,      ///< sqrt of barycentric coordinates: equal energy, continuous, no centroid error
    linear,           ///< barycentric coordinates as amplitudes
    log,              ///< log2(1 + b)
    gaussian,         ///< all tactors near, exp(-d^2 / (2 (0.6 pitch)^2)), equal energy
};
TACTOR_KIND(phantom_kind);

/// Which three tactors inverse_distance takes.
enum class faces_kind {
    delaunay, ///< those of the Delaunay face round the point, whose triangle holds it
    nearest,  ///< the three closest of the whole array, as Park et al. 2016 say; their triangle may miss it
};
TACTOR_KIND(faces_kind);

/// The SOA as it is given, or shortened so that the last burst ends with the path.
enum class timing_kind { fixed, fit };
TACTOR_KIND(timing_kind);

/// A path that leaves the array: refused, or moved to the edge.
enum class outside_kind { error, clamp };
TACTOR_KIND(outside_kind);

/// How bursts that overlap on one tactor are joined into one carrier's amplitude.
enum class overlap_kind { energy, max, sum };
TACTOR_KIND(overlap_kind);

/// What an intensity of one half means: half of the amplitude; half of the sensation level in dB; or half as
/// strong as it is felt, by Stevens's law.
enum class scale_kind { linear, sl, stevens };
TACTOR_KIND(scale_kind);

/// Where the carrier's phase starts. With `stroke` one carrier runs from the stroke's first frame on, and
/// bursts open and close it: a tactor that plays several in a row goes on without a break. With `burst` it
/// starts again with each burst (where bursts overlap on a tactor, with the first). 70 ms at 250 Hz are 17.5
/// cycles, so there the sign flips from burst to burst: the spectrum has lines at 242.9 and 257.1 Hz in place
/// of 250, and the mean is above 0.
enum class phase_kind { stroke, burst };
TACTOR_KIND(phase_kind);

/// Who is predicted to feel a plan.
enum class observer_kind {
    centroid,  ///< feels the centre of energy of what sounds
    low_speed, ///< expects low speeds
};
TACTOR_KIND(observer_kind);

/// One stroke's own values in place of those in plan_options. `phantom` also replaces a model of your own
/// (plan_options::custom_phantom).
struct stroke_choices {
    std::optional<algorithm_kind> algorithm = {};
    std::optional<phantom_kind> phantom = {};
    std::optional<double> soa_s = {};
    std::optional<double> burst_s = {};
    double level_db = 0.0; ///< of its amplitudes, whatever plan_options::scale makes of its intensity
    std::optional<faces_kind> faces = {};

    friend bool operator==(const stroke_choices&, const stroke_choices&) = default;
};

/// The time that a start counts from.
enum class start_from_kind {
    piece, ///< from the start of the piece
    start, ///< from the start of a stroke before
    end,   ///< from the end of strokes before
};
TACTOR_KIND(start_from_kind);

/// What the start of a stroke counts from. Where there are fewer strokes before it, from the start of the
/// piece.
struct start_anchor {
    start_from_kind from = start_from_kind::piece;
    /// A number of strokes. `start`: counts from the start of the stroke that is so many before this one.
    /// `end`: from the time when the last so many before this one have all ended.
    unsigned back = 1;

    friend bool operator==(const start_anchor&, const start_anchor&) = default;
};

/// When a stroke starts, in seconds from the start of the piece. `starts_s` and `ends_s` are those of the
/// strokes before it, in order. Without `start_s` the stroke starts when the one before it ends.
/// \throws error (bad_input) where the stroke would start before the piece.
[[nodiscard]] TACTOR_API double resolve_start_s(std::optional<double> start_s, const start_anchor& anchor,
                                                std::span<const double> starts_s,
                                                std::span<const double> ends_s);

enum class format_kind {
    float32, ///< FLOAT_LE, full scale 1.0
    s16,     ///< S16_LE
    s24_3,   ///< S24_3LE: packed in three bytes, as in WAV files
    s24_4,   ///< S24_LE: right-aligned in four bytes
    s32,     ///< S32_LE
};

/// Bytes of one sample.
[[nodiscard]] TACTOR_API std::size_t bytes_of(format_kind f) noexcept;

/// "float", "s16", "s24" (s24_3), "s24-4", "s32".
TACTOR_KIND(format_kind);

} // namespace v0
} // namespace tactor
