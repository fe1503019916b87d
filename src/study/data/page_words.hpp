// SPDX-License-Identifier: MIT
/// \file
/// [page] of a definition: the words of the participant's page and terminal, in the participant's language.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace tactor::detail {
class toml_table;
}

namespace tactor::study {

/// Greatest length of a definition.
inline constexpr std::size_t most_definition_bytes = std::size_t{1} << 20;

/// A text of the participant's page or terminal, other than the questions of the definition.
struct page_word {
    std::string_view key;
    std::string_view english;
};

/// Lists all texts of page and terminal in English. A definition may replace each text.
std::span<const page_word> english_page_words();

/// [page] of a definition: the words in the participant's language.
class page_words {
public:
    /// Returns the text of a key. \pre `key` is in english_page_words().
    std::string operator[](std::string_view key) const;
    void set(std::string_view key, const std::string& text) { own_[std::string(key)] = text; }
    /// Returns a warning that lists the texts without a translation. Empty if all texts or no texts are set.
    std::string warning() const;

private:
    std::map<std::string, std::string, std::less<>> own_;
};

/// Reads [page] from a definition. \throws error (bad_input) with line and column.
page_words read_page(const detail::toml_table& root);

/// Reads only [page] from the file of a definition. \throws error (bad_input) with line and column, also if
/// [page] is missing.
page_words load_page_words(const std::string& file);

} // namespace tactor::study
