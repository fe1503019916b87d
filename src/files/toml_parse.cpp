// SPDX-License-Identifier: MIT
// From text to toml++'s tables.
#include "files/toml_reader.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "core/path/number.hpp"
#include "core/suggest.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

// Deeper than any table of ours. toml++ limits nested values, but in 3.3 not dotted keys, and frees
// nested tables by recursion: a key of 100 000 dots would overflow the stack.
constexpr unsigned max_dots = 16;

bool bare(char c) noexcept
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == ' ' || c == '\t';
}

// Returns the offset behind the string that begins at i, or the end of the text.
std::size_t after_string(std::string_view t, std::size_t i)
{
    const char quote = t[i];
    const bool multiline = t.substr(i, 3) == std::string(3, quote);
    const std::string end(multiline ? 3 : 1, quote);
    for (i += end.size(); i < t.size(); ++i) {
        if (quote == '"' && t[i] == '\\')
            ++i;
        else if (t.compare(i, end.size(), end) == 0) {
            i += end.size();
            // A multi-line string may itself end in up to two quotes.
            for (unsigned own = 0; multiline && own < 2 && i < t.size() && t[i] == quote; ++own)
                ++i;
            return i;
        } else if (t[i] == '\n' && !multiline)
            return i; // toml++ will complain
    }
    return t.size();
}

void refuse_deep_keys(std::string_view t, const std::string& name)
{
    unsigned dots = 0;
    unsigned line = 1;
    std::size_t line_start = 0;
    for (std::size_t i = 0; i < t.size();) {
        const std::size_t from = i;
        if (t[i] == '"' || t[i] == '\'') {
            i = after_string(t, i);
        } else if (t[i] == '#') {
            while (i < t.size() && t[i] != '\n')
                ++i;
        } else {
            if (t[i] == '.')
                ++dots;
            else if (!bare(t[i]))
                dots = 0;
            ++i;
        }
        for (std::size_t k = from; k < i && k < t.size(); ++k) {
            if (t[k] == '\n') {
                ++line;
                line_start = k + 1;
            }
        }
        if (dots > max_dots)
            fail_at({name, line, static_cast<unsigned>(from - line_start + 1)}, "a key of too many parts",
                    "no key has more than three");
    }
}

// Returns the start of the first string without an end: on its line, or with three quotes in the text.
std::optional<std::size_t> open_string(std::string_view t)
{
    for (std::size_t i = 0; i < t.size();) {
        if (t[i] == '#') {
            i = std::min(t.find('\n', i), t.size());
        } else if (t[i] == '"' || t[i] == '\'') {
            const std::size_t from = i;
            const std::size_t quotes = t.substr(i, 3) == std::string(3, t[i]) ? 3 : 1;
            i = after_string(t, i);
            if (i < from + 2 * quotes || t.substr(i - quotes, quotes) != std::string(quotes, t[from]))
                return from;
        } else {
            ++i;
        }
    }
    return std::nullopt;
}

bool in_unit(char c) noexcept
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' ||
           static_cast<unsigned char>(c) >= 0x80;
}

// Refuses a line with a number that has a unit or a decimal comma, as people write them.
void refuse_foreign_number(std::string_view text, const source_place& line)
{
    for (unsigned i = 1; i < line.line && !text.empty(); ++i)
        text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    text = text.substr(0, text.find_first_of("\n#"));
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] == '"' || text[i] == '\'') {
            i = after_string(text, i);
            continue;
        }
        const bool value = text[i] == '=';
        if (!value && text[i] != '[' && text[i] != ',') {
            ++i;
            continue;
        }
        skip_blanks(text, ++i);
        const std::size_t begin = i;
        if (!scan_number(text, i))
            continue;
        std::size_t end = i;
        if (std::size_t digits = i + 1; value && text.substr(i, 1) == "," && scan_number(text, digits)) {
            const std::string_view number = text.substr(begin, digits - begin);
            fail_at({line.file, line.line, static_cast<unsigned>(begin + 1)},
                    fmt::format("{} has a decimal comma", quoted(number)),
                    fmt::format("write {}.{}", text.substr(begin, i - begin),
                                text.substr(i + 1, digits - i - 1)));
        }
        skip_blanks(text, end);
        const std::size_t unit = end;
        while (end < text.size() && in_unit(text[end]))
            ++end;
        if (end > unit)
            fail_at({line.file, line.line, static_cast<unsigned>(begin + 1)},
                    fmt::format("{} is a number with a unit", quoted(text.substr(begin, end - begin))),
                    "give the number alone: its unit is in the name of the key, or in the manual");
    }
}

} // namespace

toml::table parse_toml(std::string_view text, const std::string& name, const toml_hints& hints)
{
    refuse_no_text(text, name, hints.kinds);
    refuse_deep_keys(text, name);
    try {
        return toml::parse(text, std::string_view(name));
    } catch (const toml::parse_error& e) {
        refuse_other_form(text, name, "toml", hints.kinds);
        const auto& at = e.source().begin;
        if (const auto open = open_string(text)) {
            const source_place begin = find_place(text, *open, name);
            const std::string three(3, text[*open]);
            if (begin.line <= at.line)
                fail_at(begin, "this text has no closing quote",
                        text.substr(*open, 3) == three
                            ? "end it with " + three
                            : fmt::format("end it with {} on the same line", text[*open]));
        }
        if (e.description().find("utf-8") != std::string_view::npos)
            fail_at({name, at.line, at.column}, "this is not UTF-8",
                    "save it as UTF-8 in the editor, or convert it: iconv -f LATIN1 -t UTF-8 OLD > NEW");
        refuse_foreign_number(text, {name, at.line, 0});
        const std::string manual = fmt::format("see {}", hints.manual);
        if (e.description().find("could not determine value type") != std::string_view::npos)
            fail_at({name, at.line, at.column}, "this is no value",
                    "a text stands in quotes, as name = \"palm\"; numbers have no unit; " + manual);
        fail_at({name, at.line, at.column}, e.description(), manual);
    }
}

} // namespace tactor::detail
