// SPDX-License-Identifier: MIT
// The length of a cubic's piece.
#pragma once

#include "core/path/shape.hpp"

namespace tactor::detail {

/// As length_between(), from < to: the same fifteen nodes, to the last bit, several at once.
double cubic_length(const cubic& c, double from, double to) noexcept;

} // namespace tactor::detail
