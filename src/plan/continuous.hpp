// SPDX-License-Identifier: MIT
/// \file
/// What make_plan() puts into plan::at.
#pragma once

#include <memory>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// The phantom along a stroke. Who finds it in a plan (std::function::target) knows more of the plan than
/// its values: the movement behind them, and what bounds them.
struct continuous_at {
    trajectory motion;
    layout faces;
    std::shared_ptr<const phantom_model> model;
    /// No tactor is given more than the intensity asked for; of a model of the user's own nobody knows.
    bool bounded = false;

    void operator()(double t_s, burst& at) const;
};

} // namespace tactor::detail
