// SPDX-License-Identifier: MIT
/// \file
/// Comparisons as text and CSV.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "percept/compare.hpp"

namespace tactor::cli {

/// Prints a table of each comparison; `titles`: names of the strokes.
void print_text(std::FILE* out, const std::vector<detail::comparison>& all,
                const std::vector<std::string>& titles, const array& a);
/// Prints one table of all, and their warnings on standard error.
void print_csv(std::FILE* out, const std::vector<detail::comparison>& all);

} // namespace tactor::cli
