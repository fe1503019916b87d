// SPDX-License-Identifier: MIT
/// \file
/// A plan as text and CSV.
#pragma once

#include <cstdio>

#include "cli/input.hpp"

namespace tactor::cli {

/// Both write to `out` as they go: a plan of an hour needs no document in memory.
void print_text(std::FILE* out, const piece& p, const environment& e, const render_options& sound);
void print_csv(std::FILE* out, const piece& p, const environment& e);

} // namespace tactor::cli
