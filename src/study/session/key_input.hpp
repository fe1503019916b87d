// SPDX-License-Identifier: MIT
/// \file
/// Keys of a session: the participant's answers and the experimenter's commands, from standard input (a
/// terminal's keys, or lines), keypads and the participant's page.
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

/// Returns the character for a key of an input device (a code of linux/input-event-codes.h): 1 to 9 for
/// digits; + for plus and up, - for minus and down; > for right, < for left; a for A and Enter; n for N and
/// 0; b for B and Backspace; a point for a keypad's dot. Returns nothing for other keys.
std::optional<char> find_key_character(std::uint16_t code) noexcept;

/// Greatest number of answers for which each answer has a key: 1 to 9.
inline constexpr unsigned most_keys = 9;

/// A number that somebody is typing. This class does not access the terminal.
class typed_number {
public:
    /// Takes a digit, sign, point, comma, e, Backspace or Enter. Ignores other keys. Points and e are part of
    /// the text so that 1.5 and 1e5 do not become 15. At Enter, returns the typed text, if any, and clears
    /// it.
    std::optional<std::string> add_key(char key);
    const std::string& text() const noexcept { return text_; }

private:
    std::string text_ = {};
};

/// A line that somebody is typing at a terminal, in UTF-8.
class typed_text {
public:
    /// Takes a byte from the terminal: part of a character, Backspace or Enter. Ignores keys such as arrows,
    /// and characters beyond most_text_characters. Returns true at Enter.
    bool add_byte(char byte);
    /// Returns the complete characters.
    const std::string& text() const noexcept { return text_; }
    /// Returns true if nothing is typed, not even part of a character.
    bool is_empty() const noexcept { return text_.empty() && begun_.empty() && escape_ == '\0'; }

private:
    std::string text_ = {};
    std::string begun_ = {}; ///< bytes of an incomplete character
    char escape_ = '\0';     ///< last byte of an unfinished escape sequence (an arrow key sends one), or 0
};

/// Detector of keys that a terminal repeats because they are held down. It does not read a clock.
class repeat_guard {
public:
    /// Returns the time since the last key, ns. Returns the greatest value if the last key was a different
    /// key.
    std::int64_t since_ns(char key, std::int64_t at_ns) const noexcept
    {
        return key == last_ ? at_ns - last_ns_ : std::numeric_limits<std::int64_t>::max();
    }
    /// Takes a key that was read at `at_ns`. Returns true if the terminal repeated the key: it does so 10 to
    /// 60 times a second while the key is held. `again`: true if the same read returned the key once more.
    bool is_repeated(char key, std::int64_t at_ns, bool again) noexcept
    {
        const bool repeated = again || since_ns(key, at_ns) < quiet_ns;
        last_ = key;
        last_ns_ = at_ns;
        return repeated;
    }

private:
    static constexpr std::int64_t quiet_ns = 100'000'000;

    char last_ = '\0'; ///< last key; 0 before the first key
    std::int64_t last_ns_ = 0;
};

/// Hint of an error that ends a session with a person.
inline constexpr const char* resume_hint =
    "earlier answers are kept; if there are any, continue with --resume";

/// A keypad. While this object exists, no other program receives the keypad's keys. For use by one thread.
class keypad {
public:
    /// Opens a device such as /dev/input/by-id/...-event-kbd. \throws error: not_available if the device is
    /// missing, cannot be read or belongs to another program; bad_input if it is not an input device or has
    /// no key for an answer.
    explicit keypad(std::string device);
    keypad(const keypad&) = delete;
    keypad& operator=(const keypad&) = delete;

    /// Returns a descriptor that is readable when next() may have a key.
    int descriptor() const noexcept { return descriptor_.get(); }
    /// Returns the next pressed key that is an answer, if any. Does not block. \throws error (runtime) if the
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
    quit,      ///< q: ends the session, as Ctrl-C does
    back,      ///< b: goes back to the previous item; the participant may press it, too
};

/// A key, an answer from the page, or a line if standard input is not a terminal.
struct session_key {
    /// The key, the line without its blanks, the typed number, or the text from the page. Empty for a command
    /// from the terminal in a session with a page.
    std::string text = {};
    std::optional<operator_key> command = {};
    std::optional<unsigned> answer = {};     ///< number in `text`, or number of the answer on the page
    std::optional<std::string> entered = {}; ///< line with its blanks, or text from the page
    bool is_key = false;  ///< true for a key press, false for a whole line or an answer from the page
    bool is_held = false; ///< true if a terminal repeats the key
    std::int64_t since_ns = std::numeric_limits<std::int64_t>::max(); ///< repeat_guard::since_ns()
    bool from_keypad = false;
    bool is_dot = false;    ///< true for a keypad's dot key, which means b except in an estimate
    std::int64_t at_ns = 0; ///< time of the key, CLOCK_MONOTONIC
};

/// The participant's ways to answer besides the terminal.
struct answering {
    participant_page* page = nullptr;
    std::vector<std::string> keypads = {}; ///< paths of the devices
};

/// Keys of terminal, keypads and page. With a page, the participant answers only on the page and keypads, and
/// standard input takes only the experimenter's commands. While this object lives, a terminal delivers each
/// key at once and does not show it; keys that send signals still work.
class session_keys {
public:
    /// Opens the keypads. Throws the errors of keypad's constructor.
    session_keys(stage& s, const answering& with);
    ~session_keys();
    session_keys(const session_keys&) = delete;
    session_keys& operator=(const session_keys&) = delete;

    bool is_terminal() const noexcept { return terminal_; }
    /// Returns true if keys can come before the question that they answer. Lines cannot come too early: each
    /// line stays unread until its question.
    bool can_come_early() const noexcept { return terminal_ || page_ != nullptr; }
    /// Returns true if the participant can answer with keys, not only with lines.
    bool has_keys() const noexcept { return can_come_early() || !keypads_.empty(); }
    /// Returns the next key or line, if any, even if it has no meaning. Does not block. Unless `repeated` is
    /// true, skips answers that a terminal repeats, and prints a message the first time. \throws error
    /// (runtime) if an input cannot be read.
    std::optional<session_key> poll(bool repeated = false);
    /// Blocks until the next key or line, and returns it. \throws stage::interruption; error (runtime) if an
    /// input cannot be read, or if no more keys can come. In the last case `subject` is the subject of the
    /// error.
    session_key wait(const std::string& subject = "the session", bool repeated = false);
    /// Blocks until a number or a command is entered, and returns it. Shows the digits while they are typed.
    /// A line, or an answer from the page, contains the complete number. For one second, the key that
    /// answered the previous question cannot begin the number. `estimate`: true if the number may have a
    /// point. Throws as wait().
    session_key wait_for_number(typed_number& number, bool estimate);
    /// Blocks until a text is entered, and returns it in `entered` after tidy_text(). `entered` is missing if
    /// tidy_text() refused the text. With a page, this also returns the experimenter's commands. Without a
    /// page, all keys of the terminal are text, except that Backspace before the first character is the
    /// command `back`. Shows the text while it is typed. For one second, the key that answered the previous
    /// question cannot begin the text. Throws as wait().
    session_key wait_for_text(typed_text& text);
    /// Returns true if no more keys or lines can come.
    bool has_ended() const noexcept
    {
        return page_ == nullptr && ended_ && text_.empty() && keypads_.empty();
    }
    /// Drops all keys pressed so far on keypads.
    void drop_keypad_keys();
    /// Drops all keys pressed so far. Keeps lines, and the experimenter's keys in a session with a page.
    void drop_keys();

private:
    std::optional<session_key> poll_page();
    std::optional<char> poll_keypads();
    std::optional<std::string> poll_standard_input();
    void fill();

    stage& stage_;
    participant_page* page_;
    std::list<keypad> keypads_;
    detail::owned_fd any_; ///< epoll descriptor of all inputs; empty if standard input is the only input
    termios before_{};     // declared first, because the initializer of terminal_ fills it
    bool terminal_;
    std::string text_ = {};
    std::int64_t read_ns_ = 0; ///< CLOCK_MONOTONIC of the last read into text_
    repeat_guard guard_ = {};
    bool warned_ = false; ///< true after the message about a held key
    bool ended_ = false;  ///< true after the end of standard input
};

} // namespace tactor::study
