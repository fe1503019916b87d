// SPDX-License-Identifier: MIT
/// \file
/// What the participant's page shows in each step of a session. Nothing in it says by which method a motion
/// is rendered.
#pragma once

#include "cli/experiment/prepared.hpp"
#include "study/experiment/page_dialogue.hpp"
#include "study/experiment/session_flow.hpp"

namespace tactor::cli {

/// Nothing to do: `key` is the word that says why, of page_words.
study::page_screen idle_screen(const prepared_experiment& p, std::string_view key);
study::page_screen consent_screen(const prepared_experiment& p);
/// A tactor is driven, and then, with `asked`, it is asked whether it was felt.
study::page_screen walk_screen(const prepared_experiment& p, unsigned tactor, bool asked);
study::page_screen introduce_screen(const prepared_experiment& p, const study::session_step& s);
study::page_screen rest_screen(const prepared_experiment& p, const study::session_step& s);
/// Of a trial: its target, its stimuli, its question.
study::page_screen target_screen(const prepared_experiment& p, const study::session_step& s,
                                 const stroke& target);
study::page_screen stimulus_screen(const prepared_experiment& p, const study::session_step& s);
study::page_screen question_screen(const prepared_experiment& p, const study::session_step& s);

} // namespace tactor::cli
