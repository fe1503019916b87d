// SPDX-License-Identifier: MIT
/// \file
/// A participant at a terminal or a web page: plays trials on the device, and takes answers from keys, lines
/// or the page.
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
    /// Opens the keypads. `render`: the array's options without the level. `s`, `a` and `with.page` must
    /// outlive this object. \throws error.
    person(stage& s, const array& a, const render_options& render, const calibration_settings& c,
           const answering& with, const page_words& words);

    /// Plays a trial and returns the answer. \throws stage::interruption; error (runtime) if the device is
    /// lost or no more answers can come.
    calibration_answer answer(const calibration_trial& t);
    /// Shows whether the answer was right, if the session gives feedback.
    void show_feedback(const calibration_record& r);
    /// Shows on the page that the session is over.
    void show_end();

private:
    calibration_answer choose(const calibration_trial& t);
    calibration_answer adjust(const calibration_trial& t);
    /// Makes the score of a trial: total_s long, with one burst on the tactor.
    score trial_score(unsigned tactor, double level_dbfs, double onset_s, double total_s) const;
    given_stimulus play(const calibration_trial& t, const score& s, const std::function<void(double)>& watch);
    /// Waits until the limits allow the trial to drive the tactor. \throws stage::interruption.
    void wait_for_room(const score& s);
    void begin();
    void take_break();
    void show_on_page(page_screen s);

    stage& stage_;
    const array& array_;
    render_options render_;
    calibration_settings settings_;
    participant_page* page_; ///< null if there is no page
    page_words words_;
    session_keys keys_;
    question_asker asker_;
    bool begun_ = false;
    std::optional<page_progress> where_ = {};
};

} // namespace tactor::study
