// SPDX-License-Identifier: MIT
/// \file
/// Starts of the strokes of a score, which may depend on earlier strokes.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <tactor/choices.hpp>

namespace tactor::detail {

/// Starts of strokes, which come in order: start() and then lasts() for each. A stroke counts as an earlier
/// one only after lasts(). Seconds from the start of the score.
class start_times {
public:
    /// Returns the start of the next stroke.
    /// \throws error as resolve_start_s().
    double start(std::optional<double> start_s, const start_anchor& anchor)
    {
        return next_s_ = resolve_start_s(start_s, anchor, starts_s_, ends_s_);
    }
    /// Sets the duration of that stroke and returns its end.
    double lasts(double duration_s)
    {
        starts_s_.push_back(next_s_);
        ends_s_.push_back(next_s_ + duration_s);
        return ends_s_.back();
    }
    std::vector<double> all() && { return std::move(starts_s_); }

private:
    double next_s_ = 0.0;
    std::vector<double> starts_s_;
    std::vector<double> ends_s_;
};

} // namespace tactor::detail
