// SPDX-License-Identifier: MIT
/// \file
/// What a stroke may say of itself beside its movement: how it is planned, and from when its start counts.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/kinds.hpp>

namespace tactor {
inline namespace v0 {

enum class algorithm_kind { park2016, tactile_brush, continuous };

TACTOR_API std::string_view to_string(algorithm_kind k) noexcept;
template <>
TACTOR_API algorithm_kind from_string<algorithm_kind>(std::string_view name);
template <>
TACTOR_API std::span<const algorithm_kind> values_of<algorithm_kind>() noexcept;

/// Built-in phantom models.
enum class phantom_kind {
    inverse_distance, ///< Park et al. 2016, Eqs. (2) and (10)
    barycentric,      ///< sqrt of barycentric coordinates: equal energy, continuous, no centroid error
    linear,           ///< barycentric coordinates as amplitudes
    log,              ///< log2(1 + b)
    gaussian,         ///< all tactors near, exp(-d^2 / (2 (0.6 pitch)^2)), equal energy
};

TACTOR_API std::string_view to_string(phantom_kind k) noexcept;
template <>
TACTOR_API phantom_kind from_string<phantom_kind>(std::string_view name);
template <>
TACTOR_API std::span<const phantom_kind> values_of<phantom_kind>() noexcept;

/// What one stroke has in place of the common options of a plan (plan_options); a phantom wins over a model
/// of your own, too.
struct stroke_choices {
    std::optional<algorithm_kind> algorithm = {};
    std::optional<phantom_kind> phantom = {};
    std::optional<double> soa_s = {};
    std::optional<double> burst_s = {};

    friend bool operator==(const stroke_choices&, const stroke_choices&) = default;
};

/// From when a start counts.
enum class start_from_kind {
    piece, ///< from the start of the piece
    start, ///< from the start of a stroke before
    end,   ///< from the end of strokes before
};

TACTOR_API std::string_view to_string(start_from_kind k) noexcept;
template <>
TACTOR_API start_from_kind from_string<start_from_kind>(std::string_view name);
template <>
TACTOR_API std::span<const start_from_kind> values_of<start_from_kind>() noexcept;

/// What the start of a stroke counts from. Where there are fewer strokes before it, from the start of the
/// piece.
struct start_anchor {
    start_from_kind from = start_from_kind::piece;
    /// `start`: of the stroke so many before this one. `end`: when the last of so many before it has ended.
    unsigned back = 1;

    friend bool operator==(const start_anchor&, const start_anchor&) = default;
};

/// When a stroke starts, in seconds from the start of the piece; starts and ends of those before it in order.
/// Without `start_s` it is when the one before it has ended.
/// \throws error (bad_input) where that is before the piece.
[[nodiscard]] TACTOR_API double resolve_start_s(std::optional<double> start_s, const start_anchor& anchor,
                                                std::span<const double> starts_s,
                                                std::span<const double> ends_s);

} // namespace v0
} // namespace tactor
