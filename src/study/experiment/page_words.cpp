// SPDX-License-Identifier: MIT
#include "study/experiment/page_words.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace tactor::study {
namespace {

constexpr std::array all{
    page_word{"language", "en"},
    page_word{"agree", "Do you agree?"},
    page_word{"yes", "Yes"},
    page_word{"no", "No"},
    page_word{"walk", "Each place vibrates once, in turn."},
    page_word{"felt", "Did you feel it?"},
    page_word{"again", "Once more"},
    page_word{"back", "The one before"},
    page_word{"begin", "Begin"},
    page_word{"practice", "Practice"},
    page_word{"part", "Part"},
    page_word{"target", "Watch how it moves."},
    page_word{"stimulus", "Attend to your hand."},
    page_word{"rest", "A break"},
    page_word{"pause", "A pause"},
    page_word{"wait", "One moment, please."},
    page_word{"over", "That was all. Thank you."},
    page_word{"elsewhere", "This session goes on in another window."},
    page_word{"offline", "There is no connection. Please tell the experimenter."},
    page_word{"full_screen", "Full screen"},
    // Of a terminal only.
    page_word{"or", "or"},
    page_word{"to", "to"},
    page_word{"any_key_begins", "Any key begins."},
    page_word{"any_key_ends", "Any key ends."},
    page_word{"trial", "Trial"},
    page_word{"repeated", "again"},
    page_word{"later", "Once more, later."},
    page_word{"no_answer", "That is no answer"},
};

std::size_t place_of(std::string_view key)
{
    return static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(), [&](const page_word& w) { return w.key == key; }) - all.begin());
}

} // namespace

std::span<const page_word> page_words_in_english()
{
    return all;
}

page_words::page_words()
{
    for (const page_word& w : all)
        texts_.emplace_back(w.english);
}

const std::string& page_words::operator[](std::string_view key) const
{
    return texts_.at(place_of(key));
}

void page_words::set(std::string_view key, std::string text)
{
    texts_.at(place_of(key)) = std::move(text);
}

} // namespace tactor::study
