// SPDX-License-Identifier: MIT
/// \file
/// Questions of trials, questionnaires and calibrations, at the terminal and on the participant's page.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/path.hpp>
#include <tactor/stroke.hpp>

#include "study/data/page_words.hpp"
#include "study/data/questionnaire.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

/// A question with its answers: numbers from the screen's lowest to its greatest, an estimate, a text, or a
/// drawing. The terminal takes the number of a tactor in place of a drawn place.
struct question {
    page_screen screen;      ///< screen for the page; the terminal shows only its `question`
    std::string possible;    ///< possible answers for the terminal: "1 or 2"; may be empty
    std::string prompt = {}; ///< words at the terminal in place of the question and its possible answers

    bool is_text() const noexcept { return screen.entry == entry_kind::text; }
    bool is_estimate() const noexcept { return screen.entry == entry_kind::estimate; }
    bool is_drawn() const noexcept { return screen.draws != drawing_kind::none; }
    /// Returns true if an answer takes several keys and then Enter.
    bool is_typed() const noexcept;
};

struct given_answer {
    double number = 0.0;    ///< unused for a text
    std::string text;       ///< text, estimate as it was typed, or drawing as to_text() writes it
    std::int64_t at_ns = 0; ///< time of the answer, CLOCK_MONOTONIC
};

/// Asks a participant at the terminal, keypads and page.
class question_asker {
public:
    /// Keeps references: all arguments must outlive this object. `page` is null if there is none.
    question_asker(session_keys& keys, participant_page* page, const page_words& words)
        : keys_(keys), page_(page), words_(words)
    {
    }

    /// Blocks until an answer. Ignores a second press of the key that answered the previous question.
    /// `obey`: called for each command of the experimenter; returns false to stop asking, and then this
    /// returns nothing. `subject`: see session_keys::wait(). Throws as session_keys::wait().
    std::optional<given_answer> ask(const question& q, const std::function<bool(operator_key)>& obey,
                                    const std::string& subject = "the session");

private:
    bool is_second_press(const session_key& k) const;
    void show(const page_screen& s);

    session_keys& keys_;
    participant_page* page_;
    const page_words& words_;
    session_key answered_ = {}; ///< previous answer
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
question ask_about_trial(const prepared_experiment& p, const session_step& s, const planned_trial& t);

/// Returns the answer to the question of a trial, with a drawing in place of a tactor's number.
trial_answer read_trial_answer(const question& q, const given_answer& a, const array& where);

/// Returns the question of an item. `back`: the participant can go to the previous item with key b, or with
/// Backspace if a text is typed at the terminal.
question ask_about_item(const questionnaire& q, std::size_t item, const page_words& w, bool back,
                        bool on_page);

} // namespace tactor::study
