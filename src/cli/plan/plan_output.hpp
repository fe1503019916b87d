// SPDX-License-Identifier: MIT
/// \file
/// A plan as text, JSON (schemas tactor-plan/1 and tactor-plans/1) and CSV.
#pragma once

#include <cstdio>

#include <nlohmann/json_fwd.hpp>

#include "cli/input.hpp"

namespace tactor::cli {

/// All write to `out` as they go: a plan of an hour needs no document in memory.
void print_text(std::FILE* out, const piece& p, const environment& e, const render_options& sound);
/// `samples` is made of the piece with `options`: with them the JSON is a record of every sample.
void print_json(std::FILE* out, const piece& p, const environment& e, const score& samples,
                const render_options& options);
/// The array as those objects have it.
nlohmann::ordered_json array_json(const array& a);
void print_csv(std::FILE* out, const piece& p, const environment& e);

} // namespace tactor::cli
