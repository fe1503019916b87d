// SPDX-License-Identifier: MIT
/// \file
/// When the strokes of a piece start, each as the ones before it allow.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <tactor/choices.hpp>

namespace tactor::detail {

/// Takes strokes in order: start() and lasts() of each. Seconds from the start of the piece.
class start_times {
public:
    /// When the next one starts. \throws error as resolve_start_s().
    double start(std::optional<double> start_s, const start_anchor& anchor)
    {
        starts_s_.push_back(resolve_start_s(start_s, anchor, starts_s_, ends_s_));
        return starts_s_.back();
    }
    /// How long it lasts; gives its end.
    double lasts(double duration_s)
    {
        ends_s_.push_back(starts_s_.back() + duration_s);
        return ends_s_.back();
    }
    std::vector<double> all() && { return std::move(starts_s_); }

private:
    std::vector<double> starts_s_;
    std::vector<double> ends_s_;
};

} // namespace tactor::detail
