// SPDX-License-Identifier: MIT
/// \file
/// A participant at a terminal or before a page: trials on the device, answers from keys, lines or the page.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/environment.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/experiment/definition.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

class person {
public:
    /// Opens the device and the keypads. `render` has the array's options except the level. Serves a page if
    /// `listening` is a socket, with these words. \throws error.
    person(const alsa_options& device, const session::stream_options& o, const session::environment& e,
           const render_options& render, const calibration_settings& s,
           const std::vector<std::string>& keypads, net::owned_fd listening, const page_words& words);

    /// Plays noise through both intervals of each trial from now on. \throws error as open_alsa().
    void mask(const std::string& pcm, const masking_options& o) { stage_.mask(pcm, o); }
    /// Plays a trial and takes the answer to it. \throws stage::left; error (runtime) if the device is gone
    /// or no answer can come any more.
    calibration_answer answer(const calibration_trial& t);
    /// Says if the answer was right, with feedback only.
    void tell(const calibration_record& r);
    /// Says that all trials are answered.
    void thank();
    /// Ends the stream in silence. \throws error if the amplifier may be on.
    void finish() { stage_.finish(); }

private:
    calibration_answer choose(const calibration_trial& t);
    calibration_answer adjust(const calibration_trial& t);
    /// Makes a trial's score: one burst on the tactor, in a time of total_s.
    score trial_score(unsigned tactor, double level_dbfs, double onset_s, double total_s) const;
    given_stimulus play(const calibration_trial& t, const score& s, const std::function<void(double)>& watch);
    /// Lets time pass until the limits allow the trial to drive its tactor. \throws stage::left.
    void make_room(const score& s);
    void begin();
    void on_page(page_screen s);

    const session::environment& environment_;
    render_options render_;
    calibration_settings settings_;
    page_words words_;
    stage stage_;
    /// Null: none. Its thread has the signals blocked that the stage takes.
    std::unique_ptr<participant_page> page_;
    session_keys keys_;
    bool begun_ = false;
};

} // namespace tactor::study
