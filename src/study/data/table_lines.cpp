// SPDX-License-Identifier: MIT
#include "study/data/text_table.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace tactor::study {
namespace {

constexpr std::string_view ends = "\t\r\n";

// Returns the cell that begins with a quote at `at`; nothing where no quote ends it.
std::optional<table_cell> quoted_cell(std::string_view text, std::size_t at)
{
    table_cell c{.quoted = true, .begin = at};
    for (std::size_t i = at + 1; i < text.size(); ++i) {
        if (text[i] != '"') {
            c.text += text[i];
            continue;
        }
        c.end = i + 1;
        if (c.end == text.size() || ends.find(text[c.end]) != ends.npos)
            return c;
        if (text[c.end] != '"')
            return {};
        c.text += '"';
        ++i;
    }
    return {};
}

table_cell cell_at(std::string_view text, std::size_t at)
{
    if (at < text.size() && text[at] == '"')
        if (auto c = quoted_cell(text, at))
            return *std::move(c);
    const std::size_t end = std::min(text.find_first_of(ends, at), text.size());
    return {.text = std::string(text.substr(at, end - at)), .begin = at, .end = end};
}

std::size_t line_end_length(std::string_view text, std::size_t at)
{
    return text.substr(at, 2) == "\r\n" ? 2 : 1;
}

// Counts the line ends in a cell in quotes, which are lines of the file.
std::size_t count_line_ends(std::string_view text)
{
    std::size_t n = 0;
    for (std::size_t at = text.find_first_of("\r\n"); at != text.npos; at = text.find_first_of("\r\n", at)) {
        at += line_end_length(text, at);
        ++n;
    }
    return n;
}

} // namespace

std::vector<table_line> split_table(std::string_view text, std::size_t from)
{
    std::vector<table_line> lines;
    std::size_t number = 1;
    for (std::size_t at = from; at < text.size(); ++number) {
        table_line line{.number = number};
        for (bool more = true; more;) {
            line.cells.push_back(cell_at(text, at));
            at = line.end();
            number += count_line_ends(text.substr(line.cells.back().begin, at - line.cells.back().begin));
            more = at < text.size() && text[at] == '\t';
            at += more ? 1 : 0;
        }
        line.ended = at < text.size();
        if (line.ended)
            at += line_end_length(text, at);
        if (std::any_of(line.cells.begin(), line.cells.end(),
                        [](const table_cell& c) { return !c.text.empty(); }))
            lines.push_back(std::move(line));
    }
    return lines;
}

std::string written_cell(std::string_view text)
{
    if (text != "NA" && !text.starts_with('"') && text.find_first_of(ends) == text.npos)
        return std::string(text);
    std::string q = "\"";
    for (const char c : text)
        q += c == '"' ? std::string("\"\"") : std::string(1, c);
    return q + '"';
}

bool is_plain_text(std::string_view text) noexcept
{
    int more = 0; // bytes that the character still has
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte == 0 || (more > 0) != ((byte & 0xC0U) == 0x80U))
            return false;
        if (more > 0)
            --more;
        else if (byte >= 0xF8U)
            return false;
        else
            more = byte >= 0xF0U ? 3 : byte >= 0xE0U ? 2 : byte >= 0xC0U ? 1 : 0;
    }
    return more == 0;
}

} // namespace tactor::study
