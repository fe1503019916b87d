// SPDX-License-Identifier: MIT
/// \file
/// What --fit did to the places of a plan's stroke: to tactor-plan/1 and back.
#pragma once

#include <optional>

#include <nlohmann/json.hpp>
#include <tactor/phantom.hpp>

#include "files/plan/plan_values.hpp"

namespace tactor::files {

/// x' = a x + c y + e, y' = b x + d y + f, as in SVG.
nlohmann::ordered_json fit_json(const fitting& f);

/// None where the plan's stroke was not fitted. \throws error (bad_input).
std::optional<fitting> read_fitting(const json_value& plan);

} // namespace tactor::files
