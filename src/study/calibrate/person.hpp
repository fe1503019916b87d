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
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

class person {
public:
    /// Opens the device, and the keypads. `render` is what the array is driven with, without a level; a page
    /// is served where `listening` is a socket. \throws error.
    person(const alsa_options& device, const session::stream_options& o, const session::environment& e,
           const render_options& render, const calibration_settings& s,
           const std::vector<std::string>& keypads, net::owned_fd listening);

    /// Noise through both intervals of each trial from now on. \throws error as open_alsa().
    void mask(const std::string& pcm, const masking_options& o) { stage_.mask(pcm, o); }
    /// Plays a trial and takes the answer to it. \throws stage::left; error (runtime) where the device is
    /// gone or there is no answer any more.
    calibration_answer answer(const calibration_trial& t);
    /// Whether it was right, where the participant is to know.
    void tell(const calibration_record& r);
    /// That was all.
    void thank();
    /// Ends the stream in silence. \throws error where the amplifier may be on.
    void finish() { stage_.finish(); }

private:
    calibration_answer choose(const calibration_trial& t);
    calibration_answer adjust(const calibration_trial& t);
    /// Bursts of one interval each, onsets in s.
    score trial_score(unsigned tactor, double level_dbfs, double onset_s, double total_s) const;
    given_stimulus play(const calibration_trial& t, const score& s, const std::function<void(double)>& watch);
    /// Lets time pass until a trial leaves its tactor within the time that it may be driven. \throws
    /// stage::left.
    void make_room(const score& s);
    std::string wait_for_answer(const calibration_trial& t);
    bool change_level(const std::string& keys, const calibration_trial& t, double& level_dbfs,
                      std::optional<calibration_answer>& out) const;
    void begin();
    void on_page(page_screen s);
    /// What was answered, if anything was.
    std::optional<std::string> said();
    bool ended() const noexcept { return !page_ && keys_.ended(); }

    const session::environment& environment_;
    render_options render_;
    calibration_settings settings_;
    stage stage_;
    std::unique_ptr<participant_page>
        page_; ///< null: none; its thread has the signals blocked that the stage takes
    key_input keys_;
    bool begun_ = false;
};

} // namespace tactor::study
