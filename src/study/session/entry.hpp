// SPDX-License-Identifier: MIT
/// \file
/// Numbers and texts that a participant enters in place of a choice. Values without a terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactor::study {

/// Kind of answer that a participant enters in place of a choice.
enum class entry_kind {
    none,
    number, ///< a whole number
    text,   ///< one or several lines
};

/// Length of a text that a participant enters, in characters, at most.
inline constexpr std::size_t most_text_characters = 2000;

/// Returns a text with line ends as \n, blanks for tabs, and without other control characters. Returns
/// nothing for a text that is too long or no UTF-8.
std::optional<std::string> tidy_text(std::string_view entered);

/// A line that somebody types at a terminal, in UTF-8.
class typed_text {
public:
    /// Takes a byte from the terminal: one of a character, backspace or Enter; ignores arrows and the like,
    /// and characters beyond most_text_characters. Returns true at Enter.
    bool take(char byte);
    /// Returns the characters that are complete.
    const std::string& text() const noexcept { return text_; }

private:
    std::string text_ = {};
    std::string begun_ = {}; ///< bytes of a character that is not complete
    char escape_ = '\0';     ///< last byte of the sequence of an arrow or the like; 0: not in one
};

} // namespace tactor::study
