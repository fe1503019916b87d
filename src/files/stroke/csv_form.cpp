// SPDX-License-Identifier: MIT
#include "files/stroke/parts.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/path/number.hpp"
#include "core/split.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

constexpr std::string_view first_column = "t_s";
constexpr std::size_t longest_look = 4096;

[[noreturn]] void refuse_form(const source_place& at, std::string_view why, std::string_view hint)
{
    throw error(error_kind::bad_input, at, why, hint);
}

bool is_number(std::string_view s)
{
    s = without_blanks(s);
    if (s.size() > 1 && s.front() == '"' && s.back() == '"')
        s = s.substr(1, s.size() - 2);
    std::size_t end = 0;
    return is_missing(s) || (scan_number(s, end) && end == s.size());
}

void refuse_lone_cr(std::string_view text, const std::string& name)
{
    // CR before LF, or at the end of the text, ends no line.
    std::string_view first = text.substr(0, text.find('\n'));
    while (!first.empty() && first.back() == '\r')
        first.remove_suffix(1);
    if (const std::size_t at = first.find('\r'); at != std::string_view::npos)
        refuse_form(find_place(text, at, name), "its lines end in CR alone",
                    "save it with line ends of Unix, or convert it: tr '\\r' '\\n' < OLD > NEW");
}

/// Returns the word for separators other than commas in a line of names or numbers; empty for none.
std::string_view separators(std::string_view line)
{
    if (line.find(',') != std::string_view::npos && line.find(';') == std::string_view::npos)
        return {};
    for (const auto& [separator, words] : {std::pair(';', "semicolons"), {'\t', "tabs"}, {' ', "blanks"}}) {
        const std::vector<std::string_view> parts = split(line, separator);
        const auto fits = [](std::string_view s) {
            // 0,5 is a number where semicolons separate.
            return without_blanks(s).empty() || without_blanks(s) == first_column ||
                   is_number(s.substr(0, s.find(',')));
        };
        const auto holds = std::count_if(parts.begin(), parts.end(),
                                         [](std::string_view s) { return !without_blanks(s).empty(); });
        if (holds > 1 && std::any_of(parts.begin(), parts.end(), fits))
            return words;
    }
    return {};
}

} // namespace

bool is_missing(std::string_view value) noexcept
{
    return value == "NA" || (value.size() == 3 && (value[0] == 'n' || value[0] == 'N') &&
                             (value[1] == 'a' || value[1] == 'A') && (value[2] == 'n' || value[2] == 'N'));
}

void refuse_other_columns(std::string_view text, const std::string& name)
{
    refuse_lone_cr(text, name);
    source_place comment;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        // The form shows in the line's first bytes: a line may be as long as the file.
        const std::string_view line = without_blanks(text.substr(at, std::min(end - at, longest_look)));
        if (line.starts_with('#') && line.find(first_column) != std::string_view::npos)
            comment = find_place(text, at, name);
        if (line.empty() || line.starts_with('#')) {
            at = end + 1;
            continue;
        }
        const source_place here = find_place(text, at, name);
        if (const std::string_view words = separators(line); !words.empty())
            refuse_form(here, fmt::format("{} separate its columns", words),
                        words == "semicolons"
                            ? "separate them by commas, and write numbers with a decimal point"
                        : words == "tabs" ? "separate them by commas: tr '\\t' ',' < OLD > NEW"
                                          : "separate them by commas: tr -s ' ' ',' < OLD > NEW");
        const std::vector<std::string_view> parts = split(line, ',');
        if (parts.size() < 2 || !std::all_of(parts.begin(), parts.end(), is_number))
            return;
        if (comment.line != 0)
            refuse_form(comment, "the line that names the columns is a comment",
                        "take its # away; numpy.savetxt() takes comments=\"\"");
        refuse_form(here, "there is no line that names the columns", "begin with: t_s,x_mm,y_mm");
    }
}

} // namespace tactor::detail
