// SPDX-License-Identifier: MIT
/// \file
/// Keys of a session: the participant's answers, and what the experimenter asks for.
#pragma once

#include <cstdint>
#include <optional>

#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

/// The experimenter's keys.
enum class operator_key {
    repeat,    ///< r: this trial does not count, and comes again
    void_last, ///< v: the one before does not
    pause,     ///< p: before the next trial
    go_on,     ///< g: ends a pause or a break
    quit,      ///< q: as Ctrl-C
};

struct session_key {
    char character = 0;
    std::optional<operator_key> asked = {};
    unsigned answer = 0;    ///< 1 to 9, or 0
    std::int64_t at_ns = 0; ///< CLOCK_MONOTONIC
};

/// What the participant answers with, beside the terminal.
struct answering {
    participant_page* page = nullptr;
    std::vector<std::string> keypads = {}; ///< devices
};

/// With a page (none: null) the participant's keys are the page's, and standard input has only the
/// experimenter's.
class session_keys {
public:
    /// \throws error as keypad.
    session_keys(stage& s, const answering& with);

    bool is_terminal() const noexcept { return input_.is_terminal(); }
    /// Whether keys mean something before anything is asked: lines, without a page, do not.
    bool come_early() const noexcept { return is_terminal() || page_ != nullptr; }
    /// The next key, or line, where there is one; one that is none of a session's is told all the same, if it
    /// may be the participant's.
    std::optional<session_key> poll();
    /// Waits. \throws stage::left; error (runtime) where there is nothing more to come.
    session_key wait();

    /// What was pressed on a keypad up to now is not an answer to what comes.
    void drop_pressed();

private:
    stage& stage_;
    participant_page* page_;
    key_input input_;
};

} // namespace tactor::study
