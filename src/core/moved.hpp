// SPDX-License-Identifier: MIT
// A movement moved to another place and size.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Adds all corners of a movement, its ends included, and its curves.
void add_outline(const trajectory& t, std::vector<point>& corners, std::vector<shape>& curves);

/// Returns the movement mapped by `m` after `from` became the origin, which keeps the digits of a small
/// picture that is far away. If `m` flattens everything to a line, `line` gives its direction, and curves
/// become straight pieces between their turns. Time and intensity stay. `what` names the movement in
/// messages.
/// \throws error (bad_input) for coordinates beyond the limit of a path.
trajectory moved(const trajectory& t, point from, const affine& m, std::optional<point> line,
                 std::string_view what);

} // namespace tactor::detail
