// SPDX-License-Identifier: MIT
/// \file
/// Questions of trials and questionnaires, for the terminal and the participant's page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/path.hpp>
#include <tactor/stroke.hpp>

#include "study/experiment/page_words.hpp"
#include "study/experiment/questionnaire.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/participant_page.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

/// A question with its answers: numbers from the screen's lowest to its greatest, an estimate, or a text.
struct question {
    page_screen screen;   ///< screen for the page; the terminal shows only its `question`
    std::string possible; ///< possible answers for the terminal: "1 or 2"; may be empty

    bool is_text() const noexcept { return screen.entry == entry_kind::text; }
    bool is_estimate() const noexcept { return screen.entry == entry_kind::estimate; }
    /// Returns true if an answer takes several keys and then Enter.
    bool is_typed() const noexcept;
};

/// Returns the possible answers to the question of a run.
trial_answers find_answers(const experiment_definition& d, const run_definition& r);

/// Returns the progress of the session at a step.
page_progress find_progress(const prepared_experiment& p, const session_step& s);

/// Returns the position of a stroke at a time since its target's start, moved to the nearest point of the
/// array; nothing before the stroke starts and after it ends.
std::optional<point> find_place(const stroke& s, const stroke_span& when, const layout& faces, double t_s);

/// Returns these positions, by stroke, at `parts` equal parts of the target's time.
std::vector<std::vector<std::optional<point>>> sample_target(const std::vector<stroke>& target,
                                                             const array& a, double parts);

/// Returns the question of a trial.
question ask_about_trial(const prepared_experiment& p, const session_step& s);

/// Returns the question of an item. `back`: the participant can go to the previous item with key b, or with
/// Backspace if a text is typed at the terminal.
question ask_about_item(const questionnaire& q, std::size_t item, const page_words& w, bool back,
                        bool on_page);

} // namespace tactor::study
