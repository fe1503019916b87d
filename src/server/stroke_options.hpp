// SPDX-License-Identifier: MIT
/// \file
/// The parameter `options` of a request.
#pragma once

#include <optional>

#include <tactor/observer.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "net/rpc.hpp"

namespace tactor::server {

/// How a stroke is planned and how it sounds: what the owner configured, then what a client asks for.
struct stroke_settings {
    plan_options plan = {};
    render_options render = {};
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {};
    std::optional<double> usual_speed_mm_s = {}; ///< of strokes that say neither a time nor a speed
    bool compensate = false;                     ///< for low_speed
    low_speed_observer low_speed = {};
};

/// What strokes that are not planned ahead know.
enum class options_for { planned, live };

/// Puts what a client gave over the owner's. \throws fault_error naming the option.
stroke_settings with_options(stroke_settings s, const net::json& given, options_for which);

} // namespace tactor::server
