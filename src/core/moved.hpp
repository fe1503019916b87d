// SPDX-License-Identifier: MIT
// A movement in another place and size.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Adds all corners of a movement, its ends included, and its curves.
void add_outline(const trajectory& t, std::vector<point>& corners, std::vector<shape>& curves);

/// The same movement where `from` is the origin first, which keeps the digits of a small picture that is far
/// away, and then `m` maps it. With `line`, the direction of the line to which `m` flattens all, curves
/// become straight pieces between their turns. Time and intensity stay. `what` stands for it in messages.
/// \throws error (bad_input) for coordinates beyond what a path may have.
trajectory moved(const trajectory& t, point from, const affine& m, std::optional<point> line,
                 const std::function<std::string()>& what);

} // namespace tactor::detail
