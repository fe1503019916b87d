// SPDX-License-Identifier: MIT
/// \file
/// What the participant reads in each step of a session. Nothing in it says by which method a motion
/// is rendered.
#pragma once

#include <string>
#include <string_view>

#include "study/experiment/page_dialogue.hpp"
#include "study/experiment/session_flow.hpp"
#include "study/session/prepared.hpp"

namespace tactor::study {

/// Returns what can be answered in a run: "1 (not at all) to 5 (exactly)".
std::string choices_text(const experiment_definition& d, const run_definition& r);

/// Returns how many answers there are.
unsigned choices_in(const run_definition& r);

/// Nothing to do: `key` is the word that says why, of page_words.
page_screen idle_screen(const prepared_experiment& p, std::string_view key);
page_screen consent_screen(const prepared_experiment& p);
/// A tactor is driven, and then, with `asked`, it is asked whether it was felt.
page_screen walk_screen(const prepared_experiment& p, unsigned tactor, bool asked);
page_screen introduce_screen(const prepared_experiment& p, const session_step& s);
page_screen rest_screen(const prepared_experiment& p, const session_step& s);
/// Of a trial: its target, its stimuli, its question.
page_screen target_screen(const prepared_experiment& p, const session_step& s, const stroke& target);
page_screen stimulus_screen(const prepared_experiment& p, const session_step& s);
page_screen question_screen(const prepared_experiment& p, const session_step& s);

} // namespace tactor::study
