// SPDX-License-Identifier: MIT
/// \file
/// A continuous stroke: what each tactor is given, sampled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/geometry.hpp>
#include <tactor/phantom.hpp>

namespace tactor {
inline namespace v0 {

struct burst;

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

} // namespace v0
} // namespace tactor
