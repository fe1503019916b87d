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

/// A question with its possible answers: whole numbers from screen.lowest to screen.greatest, an estimate, a
/// text, or a drawing. At the terminal, the participant types a tactor's number instead of drawing a place.
struct question {
    page_screen screen;      ///< screen for the page; the terminal shows only its `question`
    std::string possible;    ///< possible answers for the terminal, such as "1 or 2"; may be empty
    std::string prompt = {}; ///< text that replaces question and possible answers at the terminal

    bool is_text() const noexcept { return screen.entry == entry_kind::text; }
    bool is_estimate() const noexcept { return screen.entry == entry_kind::estimate; }
    bool is_drawn() const noexcept { return screen.draws != drawing_kind::none; }
    /// Returns true if the participant types the answer and then presses Enter.
    bool is_typed() const noexcept;
};

struct given_answer {
    double number = 0.0;    ///< unused for a text
    std::string text;       ///< text, drawing as to_text() writes it, or the digits of `number`
    std::int64_t at_ns = 0; ///< time of the answer, CLOCK_MONOTONIC
};

/// A dialogue with a participant. It shows questions at the terminal and on the page, and takes answers from
/// terminal, keypads and page.
class question_asker {
public:
    /// Keeps references: all arguments must outlive this object. `page` is null if there is none.
    question_asker(session_keys& keys, participant_page* page, const page_words& words)
        : keys_(keys), page_(page), words_(words)
    {
    }

    /// Blocks until an answer comes, and returns it. Ignores an immediate second press of the key that
    /// answered the previous question. Calls `obey` for each command of the experimenter. If `obey` returns
    /// false, stops asking and returns nothing. `subject`: see session_keys::wait(). Throws as
    /// session_keys::wait().
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

/// Returns the progress of the session at a step.
page_progress find_progress(const prepared_experiment& p, const session_step& s);

/// Returns the position of a stroke `t_s` seconds after its target starts, moved to the nearest point of the
/// array. Returns nothing before the stroke starts or after it ends. `when`: time of the stroke in the
/// target.
std::optional<point> find_place(const stroke& s, const stroke_span& when, const layout& faces, double t_s);

/// Returns find_place() for each stroke of a target, at `parts` + 1 equally spaced times from the target's
/// start to its end.
std::vector<std::vector<std::optional<point>>> sample_target(const std::vector<stroke>& target,
                                                             const array& a, double parts);

/// Returns the question of a trial.
question make_trial_question(const prepared_experiment& p, const session_step& s, const planned_trial& t);

/// Returns the answer to the question of a trial. If the question asks for a drawing but the answer is a
/// tactor's number, returns the tactor's position as a drawing.
trial_answer read_trial_answer(const question& q, const given_answer& a, const array& where);

/// Returns the question of an item. `back`: the participant can go to the previous item with key b, or with
/// Backspace if a text is typed at the terminal.
question make_item_question(const questionnaire& q, std::size_t item, const page_words& w, bool back,
                            bool on_page);

} // namespace tactor::study
