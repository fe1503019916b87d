// SPDX-License-Identifier: MIT
/// \file
/// Contents of a curve: samples, or the stroke from which they are computed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include <tactor/plan.hpp>

#include "plan/faces/same_tactors.hpp"

namespace tactor {
inline namespace v0 {

struct curve::impl {
    explicit impl(double duration_s);
    virtual ~impl() = default;
    impl(const impl&) = delete;
    impl& operator=(const impl&) = delete;

    /// Computes a sample as curve::sample() does. `seen`: state of a reader of this curve, which makes
    /// reading faster if the reader takes neighbouring samples one after the other.
    void sample(std::uint64_t k, detail::same_tactors& seen, burst& out) const;

    /// Fills in position, intensity and drives of sample k < size.
    virtual void fill(std::uint64_t k, detail::same_tactors& seen, burst& out) const = 0;
    /// Returns a movement whose intensity (linear between the points) is an upper bound of all drives.
    /// Returns null if no bound is known, or if the curve may drive more than the first `tactors` tactors.
    virtual const trajectory* bounding_motion(std::size_t /*tactors*/) const noexcept { return nullptr; }

    const double duration_s;
    const std::uint64_t size;
};

struct curve_access {
    static curve make(std::shared_ptr<const curve::impl> p) { return curve(std::move(p)); }
    static const curve::impl& of(const curve& c) { return *c.impl_; }
};

} // namespace v0
} // namespace tactor

namespace tactor::detail {

/// Returns the number of samples of a stroke.
std::uint64_t count_samples(double duration_s) noexcept;
double sample_time_s(std::uint64_t k, double duration_s) noexcept;

/// Returns the plan with all its amplitudes and intensities multiplied by a factor above 0. Samples of a
/// curve are scaled when they are read.
plan scale_plan(plan p, double factor);

} // namespace tactor::detail
