// SPDX-License-Identifier: MIT
/// \file
/// Answers on standard input, keys of a terminal or lines, and from keypads where there are some.
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include <termios.h>
#include <unistd.h>

#include "core/owned.hpp"

namespace tactor::study {

/// What a key of an input device (its code in linux/input-event-codes.h) answers, as the key of a terminal: 1
/// to 9, of the digits, the keypad, a button box or a joystick; + - > < or the arrows; a or Enter, n or 0.
/// Nothing for others.
std::optional<char> answer_of_key(std::uint16_t code) noexcept;

/// While it lives no other program gets its keys. One thread.
class keypad {
public:
    /// Of a name such as /dev/input/by-id/...-event-kbd. \throws error (not_available) where it is not there,
    /// may not be read or is held by somebody; (bad_input) where it is no input device, or has no key that
    /// answers.
    explicit keypad(std::string device);
    keypad(const keypad&) = delete;
    keypad& operator=(const keypad&) = delete;

    /// Can be read when next() may have something.
    int descriptor() const noexcept { return descriptor_.get(); }
    /// The next key that was pressed and answers something. Does not wait. \throws error (runtime) where it
    /// is gone.
    std::optional<char> next();

private:
    void hold();

    std::string device_;
    detail::owned_fd descriptor_;
};

/// While it lives the terminal gives each key at once and shows none; a signal's keys stay what they are.
class key_input {
public:
    /// And from these keypads. `besides`: another descriptor that whoever waits wants to be woken by; -1:
    /// none. \throws error as keypad.
    explicit key_input(const std::vector<std::string>& keypads = {}, int besides = -1);
    ~key_input();
    key_input(const key_input&) = delete;
    key_input& operator=(const key_input&) = delete;

    bool is_terminal() const noexcept { return terminal_; }
    /// Whether keys come as they are pressed.
    bool has_keys() const noexcept { return terminal_ || !keypads_.empty(); }
    /// Can be read when next() may have something, or what is besides can be.
    int descriptor() const noexcept { return any_ ? any_.get() : STDIN_FILENO; }
    /// Of keys: what was pressed up to now is not an answer to what comes.
    void forget();
    /// The next key, or the next line without blanks; nothing where there is none yet. Does not wait.
    /// \throws error (runtime) where it cannot be read.
    std::optional<std::string> next();
    /// The same of the keypads alone.
    std::optional<char> pressed();
    /// The same of standard input alone.
    std::optional<std::string> typed();
    /// Whether there is nothing more to come.
    bool ended() const noexcept { return ended_ && text_.empty() && keypads_.empty(); }

private:
    void fill();
    void end();

    std::list<keypad> keypads_;
    detail::owned_fd any_; ///< an epoll of all, where standard input is not all there is
    termios before_{};     // before terminal_, whose initializer fills it
    bool terminal_;
    std::string text_ = {};
    bool ended_ = false;
};

} // namespace tactor::study
