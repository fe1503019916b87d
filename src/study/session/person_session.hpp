// SPDX-License-Identifier: MIT
/// \file
/// A session with a person at a terminal or at the participant's page. It carries out the steps of a
/// session_flow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "study/bids/session_store.hpp"
#include "study/data/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/questions.hpp"
#include "study/session/session_record.hpp"
#include "study/session/stage.hpp"
#include "study/session/sync_codes.hpp"

namespace tactor::study {

/// A terminal that shows targets.
struct target_display {
    bool moves = false; ///< false if the terminal shows a line of text instead of the target
    /// Shows a target. Returns a function that draws the target as it is `t_s` seconds after its start. The
    /// picture exists as long as the returned function. Both arguments must outlive that function.
    std::function<std::function<void(double t_s)>(const array& a, const std::vector<stroke>& target)> show;
};

/// Names of a session's devices, for session.json. A name is empty if there is no such device.
struct session_devices {
    std::string pcm = {};
    std::string pcm_server = {}; ///< sound server between the program and the card
    std::string masker = {};
    std::string masker_server = {};
};

class person_session {
public:
    /// Prepares the session. `with.page` is null if the participant uses the terminal. All arguments must
    /// outlive this object.
    person_session(const prepared_experiment& p, session_store& store, stage& s, const answering& with,
                   target_display display, session_devices devices, sync_codes& codes);

    /// Runs the rest of the session, and blocks until its end. \throws stage::interruption; error (runtime)
    /// if the participant does not agree or does not feel a tactor, no more answers can come, the device does
    /// not come back, or a file cannot be written.
    void run_session();

private:
    void step(const session_step& s);
    void ask_consent();
    void check_tactor(unsigned tactor);
    void begin_store();
    void introduce(const session_step& s);
    void run_trial(const session_step& s);
    /// Tells the participant whether the answer was right.
    void show_feedback(bool right);
    void record_pulses();
    void introduce(const questionnaire& q);
    void ask_item(const session_step& s);
    void take_break(const session_step& s);
    void pause();
    /// Shows the last screen. Returns false if the last trial was then made void, so that the session
    /// continues.
    bool end();

    /// Returns a watcher whose first call asks the participant to wait.
    std::function<bool(double)> make_wait_function();
    /// Shows the target. Returns an empty text, or the reason for a failure, which makes the trial void.
    std::string animate(const session_step& s, const planned_trial& t);
    /// Plays the stimuli of a trial. `again`: true if the trial's stimuli have played before, with the same
    /// value or another one.
    given_stimulus play_stimuli(const session_step& s, const planned_trial& t, bool again);
    /// Returns a watcher that shows which stimulus of a trial plays at a frame. A late call also shows the
    /// changes that came before the frame.
    std::function<void(std::uint64_t)> make_stimulus_watcher(const session_step& s, const planned_trial& t);
    std::optional<given_answer> ask(const question& q);

    /// Shows the participant a screen, if there is a page.
    void show_on_page(page_screen s);
    /// Obeys the experimenter's keys while something plays. Returns false if the trial must end.
    bool obey_keys();
    void handle_key(operator_key k);
    void void_last_trial();
    void wait_for_any_key();
    /// Blocks until one of these keys is pressed, and returns it. Obeys no command except q.
    char wait_for_key(std::string_view keys);
    void reopen_lost_device();
    void record_stream();

    const prepared_experiment& p_;
    session_store& store_;
    stage& stage_;
    participant_page* page_;
    target_display display_;
    session_devices devices_;
    sync_codes& codes_;
    session_keys keys_;
    question_asker asker_;
    session_flow flow_;
    std::optional<held_run> held_ = {}; ///< run in progress
    std::vector<listed_step> walked_ = {};
    std::optional<unsigned> doubted_ = {};    ///< tactor that plays again after the first No
    std::optional<session_step> voided_ = {}; ///< void trial whose code is not sent yet
    unsigned stream_ = 0;
    std::string agreed_at_ = {};                                    ///< time of consent; empty if not asked
    bool begun_ = false;                                            ///< true after begin_store()
    std::set<std::pair<std::size_t, std::size_t>> introduced_ = {}; ///< questionnaires shown: form and run
    bool repeat_ = false; ///< true if the experimenter pressed r while a stimulus plays
    bool quit_ = false;
};

} // namespace tactor::study
