// SPDX-License-Identifier: MIT
/// \file
/// What the participant's page, or terminal, says besides the definition's questions.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactor::study {

struct page_word {
    std::string_view key;
    std::string_view english;
};

/// All of them, and what they are where the definition says nothing.
std::span<const page_word> page_words_in_english();

/// [page] of a definition: the words in the participant's language.
class page_words {
public:
    page_words();

    /// \pre `key` is one of page_words_in_english().
    const std::string& operator[](std::string_view key) const;
    void set(std::string_view key, std::string text);

private:
    std::vector<std::string> texts_; // in the same order
};

} // namespace tactor::study
