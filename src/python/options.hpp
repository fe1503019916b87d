// SPDX-License-Identifier: MIT
/// \file
/// Keyword arguments, called as the tool's long options are, with _ for -.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "percept/spread.hpp"
#include "python/binding.hpp"

namespace tactor::python {

/// What plan() and Score() may be asked for. Nothing given: the tool's defaults.
struct wishes {
    plan_options plan = {};
    render_options sound = {};
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {};
    std::optional<double> usual_speed_mm_s = {}; ///< of strokes that say neither a time nor a speed
    bool fit = false;
    double fit_margin_mm = 0.0;
    std::optional<double> slope = {};
    std::optional<double> intercept_s = {};
    bool compensate = false; ///< for low_speed
    observer_kind observer = observer_kind::centroid;
    low_speed_observer low_speed = {};
    detail::spread_choice spread = {};
};

/// Takes what `given` says; None is as good as nothing. `tactors` is how many an own phantom model may name.
/// \throws error (bad_input) for names that are not known, and for values that cannot be.
void take_options(wishes& into, const py::dict& given, std::size_t tactors);

/// Names that take_options() knows, for what is to be held against the tool's.
std::vector<std::string> option_names();

/// A Python object that says which tactors make a phantom: name, and weights(x_mm, y_mm, intensity).
std::shared_ptr<const phantom_model> model_of(const py::object& own, std::size_t tactors);

} // namespace tactor::python
