// SPDX-License-Identifier: MIT
// SVG path data, the d attribute: https://www.w3.org/TR/SVG2/paths.html
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "model/path_outline.hpp"

namespace tactor::detail {

struct path_data_check {
    std::optional<value_fault> fault;          ///< the first thing that is not path data
    std::optional<std::size_t> second_subpath; ///< where a second subpath begins
};

/// Checks the grammar, and that no number is beyond `limit`.
path_data_check check_path_data(std::string_view data, double limit);

/// The subpaths that draw something, in user units. Moves that nothing follows are left out.
/// \throws value_fault
std::vector<outline> parse_path_data(std::string_view data, double limit);

} // namespace tactor::detail
