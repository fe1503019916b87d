// SPDX-License-Identifier: MIT
// SVG path data, the d attribute (https://www.w3.org/TR/SVG2/paths.html).
#pragma once

#include <string_view>
#include <vector>

#include "core/path/outline.hpp"

namespace tactor::detail {

/// Allowed subpaths of path data: with `one`, a second is a fault.
enum class subpaths { one, any };

/// Returns the subpaths that draw something, in user units. Skips moves that nothing follows. A number beyond
/// `limit` is a fault.
/// \throws value_fault at the first place that is not path data.
std::vector<outline> parse_path_data(std::string_view data, double limit, subpaths wanted);

} // namespace tactor::detail
