// SPDX-License-Identifier: MIT
/// \file
/// Answers from a device of their own: a keypad, a button box, or buttons at GPIO lines (the kernel's
/// gpio-keys).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

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

} // namespace tactor::study
