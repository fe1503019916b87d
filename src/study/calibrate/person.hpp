// SPDX-License-Identifier: MIT
/// \file
/// A participant at a terminal or before a page: trials on the device, answers from keys, lines or the page.
#pragma once

#include <functional>
#include <optional>

#include "study/calibrate/calibration.hpp"
#include "study/data/page_words.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/questions.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

class person {
public:
    /// Opens the keypads. `render` has the array's options except the level. What this keeps by reference
    /// must live as long. \throws error.
    person(stage& s, const array& a, const render_options& render, const calibration_settings& c,
           const answering& with, const page_words& words);

    /// Plays a trial and takes the answer to it. \throws stage::interruption; error (runtime) if the device
    /// is gone or no more answers can come.
    calibration_answer answer(const calibration_trial& t);
    /// Tells the participant if the answer was right, but only with feedback.
    void tell(const calibration_record& r);
    /// Shows on the page that the session is over.
    void thank();

private:
    calibration_answer choose(const calibration_trial& t);
    calibration_answer adjust(const calibration_trial& t);
    /// Makes a trial's score: one burst on the tactor, in a time of total_s.
    score trial_score(unsigned tactor, double level_dbfs, double onset_s, double total_s) const;
    given_stimulus play(const calibration_trial& t, const score& s, const std::function<void(double)>& watch);
    /// Lets time pass until the limits allow the trial to drive its tactor. \throws stage::interruption.
    void make_room(const score& s);
    void begin();
    void rest();
    void on_page(page_screen s);

    stage& stage_;
    const array& array_;
    render_options render_;
    calibration_settings settings_;
    participant_page* page_; ///< null: none
    page_words words_;
    session_keys keys_;
    question_asker asker_;
    bool begun_ = false;
    std::optional<page_progress> where_ = {};
};

} // namespace tactor::study
