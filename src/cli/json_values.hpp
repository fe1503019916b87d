// SPDX-License-Identifier: MIT
/// \file
/// A tap in JSON, of plan and compare alike.
#pragma once

#include <nlohmann/json.hpp>

#include <tactor/observer.hpp>

namespace tactor::cli {

inline nlohmann::ordered_json tap_json(const tap& t)
{
    return {{"onset_s", t.onset_s},       {"target_x_mm", t.target.x_mm}, {"target_y_mm", t.target.y_mm},
            {"alone_x_mm", t.alone.x_mm}, {"alone_y_mm", t.alone.y_mm},   {"felt_x_mm", t.felt.x_mm},
            {"felt_y_mm", t.felt.y_mm}};
}

} // namespace tactor::cli
