// SPDX-License-Identifier: MIT
#include "study/data/page_words.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "files/text_file.hpp"
#include "files/toml_reader.hpp"

namespace tactor::study {
namespace {

constexpr std::array english{
    page_word{"language", "en"},
    page_word{"agree", "Do you agree?"},
    page_word{"yes", "Yes"},
    page_word{"no", "No"},
    page_word{"same", "The same"},
    page_word{"different", "Different"},
    page_word{"walk", "Each place vibrates once, in turn."},
    page_word{"felt", "Did you feel it?"},
    page_word{"again", "Once more"},
    page_word{"back", "Back"},
    page_word{"begin", "Begin"},
    page_word{"practice", "Practice"},
    page_word{"part", "Part"},
    page_word{"at_most", "at most"},
    page_word{"target", "Watch how it moves."},
    page_word{"stimulus", "Attend to your hand."},
    page_word{"rest", "A break"},
    page_word{"pause", "A pause"},
    page_word{"wait", "One moment, please."},
    page_word{"over", "That was all. Thank you."},
    page_word{"elsewhere", "This session goes on in another window."},
    page_word{"offline", "There is no connection. Please tell the experimenter."},
    page_word{"confirm", "Confirm"},
    page_word{"any_number", "a number above 0, with a point: 0.5, 12, 1500"},
    page_word{"full_screen", "Full screen"},
    page_word{"most_different", "As different as can be"},
    page_word{"moves_first", "You change the first one."},
    page_word{"moves_second", "You change the second one."},
    page_word{"much_less", "Much less"},
    page_word{"less", "Less"},
    page_word{"more", "More"},
    page_word{"much_more", "Much more"},
    page_word{"equal", "They are equal"},
    page_word{"right", "That was right."},
    page_word{"wrong", "That was wrong."},
    // Texts that only the terminal shows.
    page_word{"or", "or"},
    page_word{"to", "to"},
    page_word{"any_key_begins", "Any key begins."},
    page_word{"any_key_ends", "Any key ends."},
    page_word{"trial", "Trial"},
    page_word{"repeated", "again"},
    page_word{"later", "Once more, later."},
    page_word{"no_answer", "That is not an answer"},
    // Texts that only the page of calibrate shows.
    page_word{"calibrate_choose",
              "There are two intervals, one of which vibrates. Which one? Guess if you do not know."},
    page_word{"calibrate_interval", "Interval"},
    page_word{"calibrate_which", "Which one vibrated?"},
    page_word{"calibrate_adjust", "Something vibrates again and again. Set it so that you just feel it."},
    page_word{"calibrate_set", "Set it so that you just feel it."},
    page_word{"calibrate_much_weaker", "Much weaker"},
    page_word{"calibrate_weaker", "Weaker"},
    page_word{"calibrate_stronger", "Stronger"},
    page_word{"calibrate_much_stronger", "Much stronger"},
    page_word{"calibrate_that_is_it", "That is it"},
    page_word{"calibrate_not_felt", "Not felt at any level"},
};

} // namespace

std::span<const page_word> english_page_words()
{
    return english;
}

std::string page_words::operator[](std::string_view key) const
{
    if (const auto own = own_.find(key); own != own_.end())
        return own->second;
    return std::string(std::ranges::find(english, key, &page_word::key)->english);
}

std::string page_words::warning() const
{
    std::vector<std::string_view> missing;
    for (const page_word& w : english)
        if (!own_.empty() && !own_.contains(w.key))
            missing.push_back(w.key);
    return missing.empty() ? ""
                           : fmt::format("[page] lacks {}, which stay English", fmt::join(missing, ", "));
}

page_words read_page(const detail::toml_table& root)
{
    page_words words;
    const auto t = root.table("page", "[page]", "[page]");
    if (!t)
        return words;
    std::vector<std::string_view> known;
    for (const page_word& w : english_page_words())
        known.push_back(w.key);
    t->refuse_other_keys(known);
    for (const std::string_view key : known)
        if (const auto text = t->text(key))
            words.set(key, *text);
    return words;
}

page_words load_page_words(const std::string& file)
{
    const detail::whole_text text = detail::read_text_file(file, most_definition_bytes);
    const toml::table document = detail::parse_toml(text, file);
    const detail::toml_table root(document, "the file", file);
    if (!root.has("page"))
        root.fail("there is no [page]", "name a definition that has the texts for the participant");
    return read_page(root);
}

} // namespace tactor::study
