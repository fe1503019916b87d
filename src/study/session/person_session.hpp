// SPDX-License-Identifier: MIT
/// \file
/// A session with somebody at a terminal or before a page: takes the steps of a session_flow on the stage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "study/bids/session_store.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/questions.hpp"
#include "study/session/stage.hpp"
#include "study/session/sync_codes.hpp"

namespace tactor::study {

/// A terminal that shows targets.
struct target_display {
    bool moves = false; ///< false: a line stands for the target
    /// Shows a target. Returns the function that draws it at a time from its start, s; the picture lasts as
    /// long as that function, and as both arguments.
    std::function<std::function<void(double t_s)>(const array& a, const stroke& target)> show;
};

/// Devices of a session, for its data; empty: none.
struct session_devices {
    std::string pcm = {};
    std::string pcm_server = {}; ///< sound server between the program and the card
    std::string masker = {};
    std::string masker_server = {};
};

class person_session {
public:
    /// `with` has the participant's page (null: the terminal). All must live as long.
    person_session(const prepared_experiment& p, session_store& store, stage& s, const answering& with,
                   target_display display, session_devices devices, sync_codes& codes);

    /// Holds the rest of the session. \throws stage::interruption; error (runtime): the participant did not
    /// agree or did not feel a tactor, no answer can come any more, the device did not come back, or the
    /// system refuses to write.
    void hold();

private:
    void step(const session_step& s);
    void ask_consent();
    void walk(unsigned tactor);
    void begin_store();
    void introduce(const session_step& s);
    void trial(const session_step& s);
    void introduce(const questionnaire& q);
    void ask_item(const session_step& s);
    void rest(const session_step& s);
    void pause();
    /// Returns false if the last trial was made void, so that the session goes on.
    bool end();

    struct given_answer {
        double number = 0.0; ///< not of a text
        std::string text;
        std::int64_t at_ns = 0; ///< CLOCK_MONOTONIC
    };
    /// Returns a watcher that asks for a moment's patience when it is first called.
    std::function<bool(double)> waiting();
    /// Shows the target. Returns the reason if that made the trial void.
    std::string animate(const session_step& s, const planned_trial& t);
    given_stimulus give(const session_step& s, const planned_trial& t);
    /// Returns a watcher that shows which of two stimuli plays at a frame, and what came before.
    std::function<void(std::uint64_t)> marks(const session_step& s, const planned_trial& t);
    std::optional<given_answer> ask(const question& q);
    bool is_second_press(const session_key& k) const;

    /// Shows the participant a screen, if there is a page.
    void on_page(page_screen s);
    /// Takes the experimenter's keys while something plays. Returns false if the trial has to end.
    bool heed();
    void obey(operator_key k);
    void void_last();
    void wait_for_any_key();
    /// Waits for one of these keys. Only q is a command meanwhile.
    char wait_for_one_of(std::string_view keys);
    void find_device();
    void note_stream();

    const prepared_experiment& p_;
    session_store& store_;
    stage& stage_;
    participant_page* page_;
    target_display display_;
    session_devices devices_;
    sync_codes& codes_;
    session_keys keys_;
    session_flow flow_;
    std::optional<held_run> held_ = {}; ///< present run
    nlohmann::ordered_json walked_ = nlohmann::ordered_json::array();
    std::optional<unsigned> doubted_ = {};    ///< tactor whose first No offered it again
    std::optional<session_step> voided_ = {}; ///< trial that the experimenter made void: its code is to come
    unsigned stream_ = 0;
    std::string agreed_at_ = {};                                    ///< time of the yes; empty: not asked
    bool begun_ = false;                                            ///< of the store
    session_key answered_ = {};                                     ///< answer before
    std::set<std::pair<std::size_t, std::size_t>> introduced_ = {}; ///< questionnaires, and the runs before
    bool repeat_ = false;                                           ///< wanted while the stimulus plays
    bool quit_ = false;
};

} // namespace tactor::study
