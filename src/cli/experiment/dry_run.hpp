// SPDX-License-Identifier: MIT
/// \file
/// `tactor experiment --dry-run`: every trial in order, and how long the runs last.
#pragma once

#include <cstdio>

#include "study/session/prepared.hpp"

namespace tactor::cli {

void print_dry_run_text(std::FILE* out, const study::prepared_experiment& p);
/// Schema tactor-experiment/1.
void print_dry_run_json(std::FILE* out, const study::prepared_experiment& p);

} // namespace tactor::cli
