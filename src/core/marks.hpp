// SPDX-License-Identifier: MIT
/// \file
/// Marks in hints. A mark stands for a name that each front end writes in the form that its users know.
///
/// {soa_s} is an option, by its field or name. {timing=fit} is an option with a value, {command:devices} a
/// command of the tool. {fit=true| scales it, } adds a clause to an option. A front end that lacks the option
/// drops the mark and its clause.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactor::detail {

struct mark {
    std::string_view text = {};    ///< the whole mark with its braces
    std::string_view setting = {}; ///< name and value: "soa_s", "timing=fit", "command:devices"
    std::string_view name = {};    ///< "timing"
    std::string_view value = {};   ///< "fit"; empty if the mark has no value
    std::string_view clause = {};  ///< text after the '|'
};

/// Finds the first mark. Other braces are not marks.
[[nodiscard]] std::optional<mark> find_mark(std::string_view text) noexcept;

/// Returns the command that a mark names, or "" if it names none.
[[nodiscard]] std::string_view command_name(const mark& m) noexcept;

/// Returns the text with each mark replaced by what `write` returns for it.
template <class Write>
std::string replace_marks(std::string_view text, Write write)
{
    std::string out;
    for (auto m = find_mark(text); m; m = find_mark(text)) {
        const auto begin = static_cast<std::size_t>(m->text.data() - text.data());
        out.append(text.substr(0, begin)).append(write(*m));
        text.remove_prefix(begin + m->text.size());
    }
    return out.append(text);
}

/// Returns a mark in the form for users of the library: "soa_s", "timing = fit".
[[nodiscard]] std::string plain(const mark& m);
/// Returns a text with each mark replaced by plain(mark) and its clause.
[[nodiscard]] std::string plain(std::string_view marked);

} // namespace tactor::detail
