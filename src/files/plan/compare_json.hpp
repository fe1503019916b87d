// SPDX-License-Identifier: MIT
/// \file
/// Comparisons as JSON (schemas tactor-compare/1 and tactor-compares/1).
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "percept/compare.hpp"

namespace tactor::files {

/// Returns one object of one comparison, a list in an object of several, and a line end.
std::string comparisons_text(const std::vector<detail::comparison>& all, const array& a);

} // namespace tactor::files
