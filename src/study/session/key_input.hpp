// SPDX-License-Identifier: MIT
/// \file
/// Answers on standard input, keys of a terminal or lines, and from keypads; and the keys of a session: the
/// participant's answers and the experimenter's commands.
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include <termios.h>
#include <unistd.h>

#include "core/owned.hpp"
#include "study/session/participant_page.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

/// Returns the answer of an input device's key (a code of linux/input-event-codes.h) as a terminal's key: 1
/// to 9 for digits, a keypad, a button box or a joystick; + - > < or the arrows; a or Enter, n or 0. Returns
/// nothing for other keys.
std::optional<char> find_answer(std::uint16_t code) noexcept;

/// Time without a key after which a terminal's key counts as pressed again. A terminal repeats a held key
/// faster, 10 to 60 times a second.
inline constexpr std::int64_t quiet_ns = 100'000'000;

/// Tells keys that a terminal repeats, because they are held down, from keys that are pressed. A value
/// without a clock.
class repeat_guard {
public:
    /// Takes a key that was read at a time; `again`: the same key was read with it, right behind it. Returns
    /// true if it is repeated.
    bool is_repeated(char key, std::int64_t at_ns, bool again) noexcept
    {
        const bool repeated = again || (key == last_ && at_ns - last_ns_ < quiet_ns);
        last_ = key;
        last_ns_ = at_ns;
        return repeated;
    }

private:
    char last_ = '\0'; ///< no key yet
    std::int64_t last_ns_ = 0;
};

/// A keypad, whose keys no other program gets while this lives. One thread.
class keypad {
public:
    /// Opens a device such as /dev/input/by-id/...-event-kbd. \throws error: not_available if it is missing,
    /// may not be read or belongs to another program; bad_input if it is no input device or has no key that
    /// answers.
    explicit keypad(std::string device);
    keypad(const keypad&) = delete;
    keypad& operator=(const keypad&) = delete;

    /// Readable when next() may have something.
    int descriptor() const noexcept { return descriptor_.get(); }
    /// Returns the next pressed key that answers something. Does not wait. \throws error (runtime) if the
    /// device is gone.
    std::optional<char> next();

private:
    void hold();

    std::string device_;
    detail::owned_fd descriptor_;
};

/// Keys from standard input and keypads. While this lives a terminal gives each key at once and shows none;
/// keys of signals stay as they are.
class key_input {
public:
    /// Opens the keypads. `besides`: another descriptor that makes descriptor() readable; -1: none. \throws
    /// error as keypad.
    explicit key_input(const std::vector<std::string>& keypads = {}, int besides = -1);
    ~key_input();
    key_input(const key_input&) = delete;
    key_input& operator=(const key_input&) = delete;

    bool is_terminal() const noexcept { return terminal_; }
    /// Returns true if keys come as they are pressed.
    bool has_keys() const noexcept { return terminal_ || !keypads_.empty(); }
    /// Readable when next() may have something or `besides` is readable.
    int descriptor() const noexcept { return any_ ? any_.get() : STDIN_FILENO; }
    /// Drops the keys that were pressed up to now; lines stay.
    void forget();
    /// Returns the next key, or the next line without blanks; nothing if there is none yet. Does not wait.
    /// \throws error (runtime) if it cannot be read.
    std::optional<std::string> next();
    /// Returns true if the last key from next() or typed() is one that the terminal repeats. Never true of
    /// lines and keypads.
    bool is_repeated() const noexcept { return repeated_; }
    /// Says, the first time, that a held key does not answer.
    void tell_of_repeats();
    /// Returns the next key of the keypads alone.
    std::optional<char> pressed();
    /// Returns the next key or line of standard input alone.
    std::optional<std::string> typed();
    /// Returns true if nothing more can come.
    bool ended() const noexcept { return ended_ && text_.empty() && keypads_.empty(); }

private:
    void fill();
    void end();

    std::list<keypad> keypads_;
    detail::owned_fd any_; ///< an epoll of all, if standard input is not alone
    termios before_{};     // before terminal_, whose initializer fills it
    bool terminal_;
    std::string text_ = {};
    std::int64_t read_ns_ = 0; ///< CLOCK_MONOTONIC at which text_ was read
    repeat_guard guard_ = {};
    bool repeated_ = false;
    bool told_ = false;
    bool ended_ = false;
};

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
    bool repeated = false;  ///< held down: it answers nothing. Never true of the experimenter's keys
    std::int64_t at_ns = 0; ///< CLOCK_MONOTONIC
};

/// The participant's ways to answer besides the terminal.
struct answering {
    participant_page* page = nullptr;
    std::vector<std::string> keypads = {}; ///< devices
};

/// Keys of terminal, keypads and page. With a page (none: null) the participant's keys are the page's, and
/// standard input has only the experimenter's.
class session_keys {
public:
    /// Opens the keypads. \throws error as keypad.
    session_keys(stage& s, const answering& with);

    bool is_terminal() const noexcept { return input_.is_terminal(); }
    /// Returns true if keys count before a question: lines without a page do not.
    bool come_early() const noexcept { return is_terminal() || page_ != nullptr; }
    /// Returns the next key or line, if any; also an unknown one that may be the participant's.
    std::optional<session_key> poll();
    /// Waits for a key that is not held down. \throws stage::left; error (runtime) if nothing more can come.
    session_key wait();

    /// Drops keys that were pressed on a keypad up to now.
    void drop_pressed();

private:
    stage& stage_;
    participant_page* page_;
    key_input input_;
};

} // namespace tactor::study
