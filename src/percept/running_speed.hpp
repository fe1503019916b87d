// SPDX-License-Identifier: MIT
/// \file
/// The speed of what is felt, sample by sample.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <tactor/percept.hpp>

#include "core/distance.hpp"

namespace tactor::detail {

/// Takes the positions felt as they come, and knows the speed as soon as the window has passed. Where nothing
/// is felt, the last position is held.
class running_speed {
public:
    /// Samples on either side of the one in the middle of the window.
    static constexpr std::size_t half_window = 50;
    static_assert(percept_window_s == 2 * half_window * percept_step_s);
    /// So many samples back is the one whose speed next() returns.
    static constexpr std::size_t delay = half_window + 1;

    std::optional<double> next(const std::optional<point>& felt)
    {
        if (count_ == 0) {
            if (!felt)
                return {};
            origin_ = *felt;
        }
        held_ = felt.value_or(held_);
        // Relative to the first one, for the sake of precision.
        const std::size_t j = count_++;
        const point& before = sums_[j % capacity];
        sums_[(j + 1) % capacity] = {before.x_mm + (held_.x_mm - origin_.x_mm),
                                     before.y_mm + (held_.y_mm - origin_.y_mm)};
        felt_[j % capacity] = felt.has_value();
        if (j < 2 * delay)
            return {};
        const std::size_t middle = j - delay;
        was_felt_ = felt_[middle % capacity];
        return length_mm(average(middle + 1), average(middle - 1)) / (2.0 * percept_step_s);
    }

    /// Whether anything was felt at the sample whose speed was returned.
    bool was_felt() const noexcept { return was_felt_; }

private:
    static constexpr std::size_t capacity = 128;
    static_assert(capacity >= 2 * delay + 2);

    point average(std::size_t i) const
    {
        constexpr double width = 2 * half_window + 1;
        const point& before = sums_[(i - half_window) % capacity];
        const point& after = sums_[(i + half_window + 1) % capacity];
        return {(after.x_mm - before.x_mm) / width, (after.y_mm - before.y_mm) / width};
    }

    std::size_t count_ = 0; // from the first one felt on
    point origin_;
    point held_;
    std::array<point, capacity> sums_{}; // of the first so many
    std::array<bool, capacity> felt_{};
    bool was_felt_ = false;
};

} // namespace tactor::detail
