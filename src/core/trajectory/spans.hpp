// SPDX-License-Identifier: MIT
// A trajectory in the pieces between which something changes, so that bounds can be computed, not sampled.
#pragma once

#include <functional>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// A stretch of time in which the target moves along one straight line, or along one curve.
struct trajectory_span {
    double from_s = 0.0;
    double to_s = 0.0;
    double intensity = 0.0;                            ///< the greatest
    const shape* curve = nullptr;                      ///< none: a straight line, or a rest
    std::function<double(double parameter)> time_at{}; ///< of a curve: when it is at a parameter of it
};

/// Calls `visit` for each, in order of time and without gaps from 0 to the duration, until it gives false.
void for_each_span(const trajectory& t, const std::function<bool(const trajectory_span&)>& visit);

} // namespace tactor::detail
