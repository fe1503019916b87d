// SPDX-License-Identifier: MIT
/// \file
/// Keys of a session: the participant's answers and the experimenter's commands, from standard input (keys of
/// a terminal, or lines), keypads and the participant's page.
#pragma once

#include <cstdint>
#include <limits>
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
/// to 9 for digits; + - > < or the arrows; a or Enter, n or 0, b or Backspace, a keypad's dot. Returns
/// nothing for other keys.
std::optional<char> find_answer(std::uint16_t code) noexcept;

/// Greatest number of answers that have a key each.
inline constexpr unsigned most_keys = 9;

/// A number that somebody types. A value without a terminal.
class typed_number {
public:
    /// Takes a key: a digit, a sign, a point, a comma or an e, so that 1.5 and 1e5 do not become 15;
    /// backspace or Enter; ignores others. Returns what was typed, if anything, at Enter, and then begins
    /// anew.
    std::optional<std::string> take(char key);
    const std::string& text() const noexcept { return text_; }

private:
    std::string text_ = {};
};

/// A line that somebody types at a terminal, in UTF-8.
class typed_text {
public:
    /// Takes a byte from the terminal: one of a character, backspace or Enter; ignores arrows and the like,
    /// and characters beyond most_text_characters. Returns true at Enter.
    bool take(char byte);
    /// Returns the characters that are complete.
    const std::string& text() const noexcept { return text_; }
    /// Returns true if not even a part of a character is there.
    bool is_empty() const noexcept { return text_.empty() && begun_.empty() && escape_ == '\0'; }

private:
    std::string text_ = {};
    std::string begun_ = {}; ///< bytes of a character that is not complete
    char escape_ = '\0';     ///< last byte of the sequence of an arrow or the like; 0: not in one
};

/// Tells keys that a terminal repeats, because they are held down, from keys that are pressed. A value
/// without a clock.
class repeat_guard {
public:
    /// Returns the time since the same key was last taken; the greatest if another one was.
    std::int64_t since_ns(char key, std::int64_t at_ns) const noexcept
    {
        return key == last_ ? at_ns - last_ns_ : std::numeric_limits<std::int64_t>::max();
    }
    /// Takes a key that was read at a time; `again`: the same key was read with it, right behind it. Returns
    /// true if it is repeated: a terminal repeats a held key 10 to 60 times a second.
    bool is_repeated(char key, std::int64_t at_ns, bool again) noexcept
    {
        const bool repeated = again || since_ns(key, at_ns) < quiet_ns;
        last_ = key;
        last_ns_ = at_ns;
        return repeated;
    }

private:
    static constexpr std::int64_t quiet_ns = 100'000'000;

    char last_ = '\0'; ///< no key yet
    std::int64_t last_ns_ = 0;
};

/// Hint of an error that ends a session with a person.
inline constexpr const char* resume_hint = "the answers are kept; --resume continues";

/// A keypad, whose keys no other program gets while this lives. One thread.
class keypad {
public:
    /// Opens a device such as /dev/input/by-id/...-event-kbd. \throws error: not_available if it is missing,
    /// may not be read or belongs to another program; bad_input if it is no input device or has no key that
    /// answers.
    explicit keypad(std::string device);
    keypad(const keypad&) = delete;
    keypad& operator=(const keypad&) = delete;

    /// Readable when next() may have a key.
    int descriptor() const noexcept { return descriptor_.get(); }
    /// Returns the next pressed key that answers something. Does not wait. \throws error (runtime) if the
    /// device is gone.
    std::optional<char> next();

private:
    std::string device_;
    detail::owned_fd descriptor_;
};

/// The experimenter's keys.
enum class operator_key {
    repeat,    ///< r: makes this trial void and repeats it later
    void_last, ///< v: makes the previous trial void
    pause,     ///< p: pauses before the next trial
    go_on,     ///< g: ends a pause or a break
    quit,      ///< q: as Ctrl-C
    back,      ///< b: asks the item before again; the participant's key, too
};

/// A key, or a line of standard input that is no terminal.
struct session_key {
    /// Without blanks; a number that was typed, a text from the page; empty for a command from a terminal
    /// beside a page.
    std::string text = {};
    std::optional<operator_key> command = {};
    std::optional<unsigned> answer = {};     ///< the number that this is, or that of the page's answer
    std::optional<std::string> entered = {}; ///< a line with its blanks; a text from the page
    bool is_key = false;                     ///< of a terminal or a keypad: a number may have more digits
    bool is_held = false;                    ///< a terminal repeats it
    std::int64_t since_ns = std::numeric_limits<std::int64_t>::max(); ///< see repeat_guard
    bool from_keypad = false;
    bool is_dot = false;    ///< the dot of a keypad, which is b unless an estimate is typed
    std::int64_t at_ns = 0; ///< CLOCK_MONOTONIC
};

/// The participant's ways to answer besides the terminal.
struct answering {
    participant_page* page = nullptr;
    std::vector<std::string> keypads = {}; ///< devices
};

/// Keys of terminal, keypads and page. With a page (none: null) the participant's keys are the page's, and
/// standard input has only the experimenter's. While this lives a terminal gives each key at once and shows
/// none; keys of signals stay as they are.
class session_keys {
public:
    /// Opens the keypads. \throws error as keypad.
    session_keys(stage& s, const answering& with);
    ~session_keys();
    session_keys(const session_keys&) = delete;
    session_keys& operator=(const session_keys&) = delete;

    bool is_terminal() const noexcept { return terminal_; }
    /// Returns true if keys count before a question: lines without a page do not.
    bool come_early() const noexcept { return terminal_ || page_ != nullptr; }
    /// Returns true if the participant has keys, not only lines.
    bool has_keys() const noexcept { return come_early() || !keypads_.empty(); }
    /// Returns the next key or line, if any, also an unknown one. Unless `repeated` leaves out keys that a
    /// terminal repeats, and says so the first time. \throws error (runtime) if a source cannot be read.
    std::optional<session_key> poll(bool repeated = false);
    /// Waits for the next key. \throws stage::interruption; error (runtime) as poll(), and if nothing more
    /// can come; `subject` names what then has no answer.
    session_key wait(const std::string& subject = "the session", bool repeated = false);
    /// Waits for a number, or for a command. Shows the digits as keys type them; lines and the page give the
    /// whole number. The key that was pressed for the question before types no first digit. `estimate`: the
    /// number may have a point. Throws as wait().
    session_key wait_for_number(typed_number& number, bool estimate);
    /// Waits for `entered`, a tidy text; if the key has none, the participant's text was refused. Waits for
    /// the experimenter's commands, too, if there is a page: else what somebody types is text, and Backspace
    /// before it is the command `back`. Shows the text as keys type it. The key that was pressed for the
    /// question before is not its first. Throws as wait().
    session_key wait_for_text(typed_text& text);
    /// Returns true if nothing more can come.
    bool ended() const noexcept { return page_ == nullptr && ended_ && text_.empty() && keypads_.empty(); }
    /// Drops keys that were pressed on a keypad up to now.
    void drop_pressed();
    /// Drops the keys that were pressed up to now; lines stay, and the experimenter's keys beside a page.
    void drop_keys();

private:
    std::optional<session_key> poll_page();
    std::optional<char> pressed();
    std::optional<std::string> typed();
    void fill();

    stage& stage_;
    participant_page* page_;
    std::list<keypad> keypads_;
    detail::owned_fd any_; ///< an epoll of all, if standard input is not alone
    termios before_{};     // before terminal_, whose initializer fills it
    bool terminal_;
    std::string text_ = {};
    std::int64_t read_ns_ = 0; ///< CLOCK_MONOTONIC at which text_ was read
    repeat_guard guard_ = {};
    bool warned_ = false; ///< of a key that is held down
    bool ended_ = false;  ///< standard input
};

} // namespace tactor::study
