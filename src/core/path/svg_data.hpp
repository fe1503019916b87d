// SPDX-License-Identifier: MIT
// SVG path data, the d attribute: https://www.w3.org/TR/SVG2/paths.html
#pragma once

#include <string_view>
#include <vector>

#include "core/path/outline.hpp"

namespace tactor::detail {

/// How many subpaths path data may have; where it may have one, a second is a fault.
enum class subpaths { one, any };

/// The subpaths that draw something, in user units. Moves that nothing follows are left out. A number beyond
/// `limit` is a fault.
/// \throws value_fault at the first thing that is not path data
std::vector<outline> parse_path_data(std::string_view data, double limit, subpaths wanted);

} // namespace tactor::detail
