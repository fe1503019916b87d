// SPDX-License-Identifier: MIT
/// \file
/// Plans as JSON (schemas tactor-plan/1 and tactor-plans/1): a record of every sample.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <tactor/array.hpp>
#include <tactor/tactor.hpp>

#include "percept/compare.hpp"

namespace tactor::files {

/// Takes the next part of a text. Whatever it throws ends the writing.
using text_sink = std::function<void(std::string_view)>;

/// Plans of one score, and everything that its samples depend on. What it refers to must outlive it.
struct plan_record {
    std::span<const stroke> strokes;
    std::span<const placed_plan> plans;      ///< one a stroke
    std::span<const compensated_plan> moved; ///< what compensation did; none, or one a plan
    const fitting* fit;                      ///< what fitting did to all strokes; null without
    const array& tactors;
    const score& samples;          ///< of all plans, made with `options`
    const render_options& options; ///< with rate and channels
};

/// Writes one object a plan, row by row: a plan of an hour needs no document in memory.
void write_plans(const plan_record& r, const text_sink& out);

/// Returns what write_plans() writes.
std::string plans_text(const plan_record& r);

/// Returns the member "array" of a plan.
nlohmann::ordered_json array_json(const array& a);

/// Returns what a stroke's note means, for people; empty for none.
std::string note_text(note_kind n);

/// Returns what a prediction says in numbers, and why it says nothing.
nlohmann::ordered_json errors_json(const detail::prediction& r, observer_kind by);

/// Returns one object of one comparison, a list in an object of several, and a line end.
std::string comparisons_text(const std::vector<detail::comparison>& all, const array& a);

} // namespace tactor::files
