// SPDX-License-Identifier: MIT
/// \file
/// Start times of the strokes of a score. A start may depend on earlier strokes.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <tactor/choices.hpp>

namespace tactor::detail {

/// Start times of strokes, in seconds from the start of the score. For each stroke in order, call start() and
/// then set_duration(). A later stroke can refer to a stroke only after set_duration() has been called for
/// it.
class start_times {
public:
    /// Returns the start of the next stroke.
    /// \throws the errors of resolve_start_s().
    double start(std::optional<double> start_s, const start_anchor& anchor)
    {
        return next_s_ = resolve_start_s(start_s, anchor, starts_s_, ends_s_);
    }
    /// Sets the duration of the stroke whose start() was called last. Returns the stroke's end.
    double set_duration(double duration_s)
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
