// SPDX-License-Identifier: MIT
/// \file
/// Distances of felt places from a target: at the same time, along and across the path, at a lag, and from
/// the nearest point of the path.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactor/path.hpp>
#include <tactor/percept.hpp>
#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Number of lags that are tried: 0, 1, 2 ... 200 ms.
inline constexpr std::size_t lag_count = 201;
static_assert(longest_lag_s == (lag_count - 1) * percept_step_s);

/// Places of a target at a time t and at each of the 200 ms before t. The last place is the place at t.
struct target_window {
    const double* x_mm; ///< lag_count values, ascending in time
    const double* y_mm;
};

/// Places of a target at 0, 1, 2 ... ms, and the path of straight pieces through them.
class target_places {
public:
    /// \throws error (bad_input) if the movement is longer than longest_percept_s.
    explicit target_places(const trajectory& m);
    /// Takes the targets of samples. There must be at least one sample.
    explicit target_places(const std::vector<percept_sample>& samples);

    std::size_t size() const noexcept { return x_mm_.size() - (lag_count - 1); }
    /// Returns the place at i ms.
    point at(std::size_t i) const noexcept { return {x_mm_[i + lag_count - 1], y_mm_[i + lag_count - 1]}; }
    /// Returns the places at i ms and before. At times before 0 the target is at the start.
    target_window window(std::size_t i) const noexcept { return {&x_mm_[i], &y_mm_[i]}; }
    /// Returns the unit vector of the movement at i ms, or nothing while the target rests.
    std::optional<point> direction(std::size_t i) const noexcept;
    /// Returns the distance of p from the path. If the path has more than most_pieces pieces, the distance is
    /// accurate to 0.015 mm. `near`: any point of the path; a point near p makes the search shorter.
    double path_distance_mm(point p, point near) const noexcept;

private:
    static constexpr std::size_t fan = 16;
    static constexpr std::size_t most_pieces = 10'000;

    void add(point p);
    void choose_pieces();
    void make_boxes();
    point piece_end(std::size_t piece) const noexcept { return at(std::min(piece + 1, size() - 1)); }
    void search(std::size_t level, std::size_t i, point p, double& square) const noexcept;

    std::vector<double> x_mm_; ///< lag_count - 1 copies of the first place, then all places
    std::vector<double> y_mm_;
    std::vector<std::uint32_t> pieces_; ///< index of the first place of each piece to search; at least one
    /// Boxes around 16 pieces each, then boxes around 16 boxes each, up to a single box.
    std::vector<std::vector<box>> boxes_;
};

/// Errors of felt places, summed place by place.
class path_errors {
public:
    /// `targets` must outlive this object.
    explicit path_errors(const target_places& targets) : targets_(targets) {}

    /// Adds the felt place at i ms. Times must ascend over the calls of both functions.
    void add(std::size_t i, point felt) { add(i, targets_.window(i), felt); }
    /// Adds a felt place with the targets in `window`. Uses the direction of the movement at i ms.
    void add(std::size_t i, target_window window, point felt);

    /// Sets the errors in a summary. Does nothing if no place was added.
    void report(percept_summary& r) const;

private:
    std::optional<point> last_direction(std::size_t i);

    const target_places& targets_;
    std::optional<point> direction_;         ///< latest direction, or the first one before any movement
    std::size_t next_ = 0;                   ///< first time, ms, whose direction is not yet known
    std::array<double, lag_count> lagged_{}; ///< sums of squares, by place in the window
    double felt_ = 0.0;
    double largest_ = 0.0;
    double along_ = 0.0; ///< sums of squares
    double across_ = 0.0;
    double off_path_ = 0.0;
    double along_max_ = 0.0;
    double across_max_ = 0.0;
    std::optional<point> last_felt_; ///< felt place whose distance from the path is last_off_mm_
    double last_off_mm_ = 0.0;
};

} // namespace tactor::detail
