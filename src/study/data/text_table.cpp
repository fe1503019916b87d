// SPDX-License-Identifier: MIT
#include "study/data/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/split.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"

namespace tactor::study {
namespace {

constexpr std::string_view utf8_hint = "save it as UTF-8, or convert it: iconv -f LATIN1 -t UTF-8 OLD > NEW";

constexpr std::string_view ends = "\t\r\n";

// Returns the cell whose opening quote is at `at`; nothing if no closing quote ends it.
std::optional<table_cell> parse_quoted_cell(std::string_view text, std::size_t at)
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

table_cell parse_table_cell(std::string_view text, std::size_t at)
{
    if (at < text.size() && text[at] == '"')
        if (auto c = parse_quoted_cell(text, at))
            return *std::move(c);
    const std::size_t end = std::min(text.find_first_of(ends, at), text.size());
    return {.text = std::string(text.substr(at, end - at)), .begin = at, .end = end};
}

std::size_t line_end_length(std::string_view text, std::size_t at)
{
    return text.substr(at, 2) == "\r\n" ? 2 : 1;
}

// Splits a text into lines and cells, from the byte `from` on.
std::vector<table_line> split_table(std::string_view text, std::size_t from)
{
    std::vector<table_line> lines;
    for (std::size_t at = from; at < text.size();) {
        table_line line;
        for (bool more = true; more;) {
            line.cells.push_back(parse_table_cell(text, at));
            at = line.end();
            more = at < text.size() && text[at] == '\t';
            at += more ? 1 : 0;
        }
        line.ended = at < text.size();
        if (line.ended)
            at += line_end_length(text, at);
        if (std::ranges::any_of(line.cells, [](const table_cell& c) { return !c.text.empty(); }))
            lines.push_back(std::move(line));
    }
    return lines;
}

// Returns a cell's text as it is written to a file. Adds quotes if a program could misread the text: R treats
// any quotation mark as the start of a quoted text.
std::string format_table_cell(std::string_view text)
{
    if (text != "NA" && text.find_first_of("\t\r\n\"'") == text.npos)
        return std::string(text);
    std::string q = "\"";
    for (const char c : text)
        q += c == '"' ? std::string("\"\"") : std::string(1, c);
    return q + '"';
}

// Returns true for UTF-8 without zero bytes.
bool is_plain_text(std::string_view text) noexcept
{
    int more = 0; // bytes still missing from the character
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

} // namespace

std::string read_file(const std::filesystem::path& file)
{
    constexpr std::size_t most_bytes = std::size_t{64} << 20; // a trial takes about 200 bytes
    std::error_code failed;
    const std::filesystem::file_status s = std::filesystem::status(file, failed);
    if (!std::filesystem::exists(s))
        throw error(error_kind::bad_input, source_place{file.string()}, failed.message(),
                    "name a folder that tactor experiment wrote")
            .with_os_code(failed.value());
    if (!std::filesystem::is_regular_file(s))
        throw error(error_kind::bad_input, source_place{file.string()}, "it is not a regular file",
                    "replace it with a regular file");
    return std::string(
        std::string_view(detail::read_text_file(file, most_bytes, detail::owner_kind::program)));
}

bool exists_in_study(const std::filesystem::path& study, const std::filesystem::path& below)
{
    namespace fs = std::filesystem;
    fs::path at = study;
    std::error_code failed;
    const auto refuse = [&](std::string_view why) {
        throw error(error_kind::bad_input, source_place{at.string()}, why,
                    "restore the original, or leave out the participant with {exclude}")
            .with_os_code(failed.value());
    };
    for (const fs::path& part : below) {
        if (at != study && !fs::is_directory(at, failed))
            refuse(failed ? failed.message() : "it is not a folder");
        at /= part;
        if (fs::symlink_status(at, failed).type() == fs::file_type::not_found)
            return false;
        if (fs::status(at, failed).type() == fs::file_type::not_found)
            refuse("it is a broken link");
        if (failed)
            refuse(failed.message());
    }
    return true;
}

std::string header_line(const named_cells& cells)
{
    std::string header;
    for (const auto& [column, text] : cells)
        header += fmt::format("{}{}", header.empty() ? "" : "\t", column);
    return header + "\n";
}

text_table::text_table(const std::filesystem::path& file, last_line end)
    : text_table(file, read_file(file), end)
{
}

text_table::text_table(const std::filesystem::path& file, std::string text, last_line end)
    : file_(file.string()), text_(std::move(text))
{
    detail::refuse_non_text(text_, file_, "save it as text with tabs between the columns");
    std::vector<table_line> lines =
        split_table(text_, text_.size() - detail::strip_byte_order_mark(text_).size());
    if (lines.empty())
        throw error(error_kind::bad_input, source_place{file_}, "it is empty",
                    "name the columns in the first line");
    take_header(std::move(lines.front()));
    for (std::size_t i = 1; i < lines.size(); ++i)
        take_row(std::move(lines[i]), end == last_line::may_be_cut);
}

void text_table::take_header(table_line line)
{
    // Separators that other programs use by default.
    constexpr std::pair<char, std::string_view> others[] = {
        {',', "commas"}, {';', "semicolons"}, {' ', "spaces"}};
    for (const auto& [sign, name] : others)
        if (line.cells.size() == 1 && line.cells.front().text.find(sign) != std::string::npos)
            refuse_at(
                line.begin(), fmt::format("{} separate the columns, not tabs", name),
                "save it with tabs: in a spreadsheet as text with {Tab} between fields, in R and pandas with "
                "sep = \"\\t\"");
    while (line.cells.back().text.empty())
        line.cells.pop_back();
    if (line.ended && text_[line.end()] == '\r')
        line_end_ = text_.substr(line.end(), 2) == "\r\n" ? "\r\n" : "\r";
    for (table_cell& c : line.cells) {
        if (!is_plain_text(c.text))
            refuse_at(line.begin(), "a column's name is not UTF-8", utf8_hint);
        if (c.text.empty())
            refuse_at(line.begin(), "a column has no name",
                      "leave out row numbers: index = False in pandas, row.names = FALSE in R");
        if (has(c.text))
            refuse_at(line.begin(), fmt::format("the column {} occurs twice", c.text),
                      "give each column its own name");
        columns_.push_back(std::move(c.text));
    }
}

void text_table::take_row(table_line line, bool may_be_cut)
{
    while (line.cells.size() > columns_.size() && line.cells.back().text.empty())
        line.cells.pop_back();
    const bool plain = std::ranges::all_of(line.cells, is_plain_text, &table_cell::text);
    cut_ = may_be_cut && !line.ended && (!plain || line.cells.size() < columns_.size());
    if (cut_)
        return rows_.push_back(std::move(line));
    if (!plain)
        refuse_at(line.begin(), "the line is not UTF-8", utf8_hint);
    if (line.cells.size() == columns_.size() + 1 && rows_.empty() && line.cells.front().text == "1")
        refuse_at(line.begin(), "the line begins with a row number, but no column has it",
                  "leave out row numbers: row.names = FALSE in R");
    if (line.cells.size() != columns_.size())
        refuse_at(
            line.begin(),
            fmt::format("the line has {}, not {}", counted(line.cells.size(), "column"), columns_.size()),
            "separate cells by tabs, and write n/a in empty ones");
    rows_.push_back(std::move(line));
}

std::optional<std::size_t> text_table::find(std::string_view column) const
{
    const auto at = std::ranges::find(columns_, column);
    return at == columns_.end() ? std::nullopt
                                : std::optional(static_cast<std::size_t>(at - columns_.begin()));
}

void text_table::need_column(std::string_view column) const
{
    if (!has(column))
        refuse_at(0, fmt::format("the column {} is missing", column),
                  "add this column: tactor-analyze(1) lists the columns");
}

std::optional<std::string_view> text_table::cell(std::size_t row, std::string_view column) const
{
    need_column(column);
    const table_cell& c = rows_[row].cells[*find(column)];
    return c.missing() ? std::nullopt : std::optional<std::string_view>(c.text);
}

std::string_view text_table::need(std::size_t row, std::string_view column) const
{
    const auto text = cell(row, column);
    if (!text)
        refuse(row, fmt::format("{} is missing", column), "give a value: n/a is not allowed here");
    return *text;
}

std::optional<unsigned> text_table::whole(std::size_t row, std::string_view column, unsigned least,
                                          unsigned most) const
{
    const auto text = cell(row, column);
    if (!text)
        return {};
    const auto v =
        detail::parse_number_text<double>(*text); // pandas writes 3 as 3.0 if another row has no value
    if (!v || *v != std::floor(*v) || *v < least || *v > most)
        refuse(row, fmt::format("{} is \"{}\"", column, *text),
               fmt::format("give a whole number from {} to {}", least, most));
    return static_cast<unsigned>(*v);
}

std::optional<double> text_table::number(std::size_t row, std::string_view column) const
{
    const auto text = cell(row, column);
    if (!text)
        return {};
    const auto v = detail::parse_number_text<double>(*text);
    if (!v || !std::isfinite(*v))
        refuse(row, fmt::format("{} is \"{}\"", column, *text), "give a number with a decimal point, or n/a");
    return v;
}

bool text_table::truth(std::size_t row, std::string_view column) const
{
    const std::string_view text = need(row, column);
    const std::string small = to_lower_case(std::string(text));
    if (small != "true" && small != "false")
        refuse(row, fmt::format("{} is \"{}\"", column, text), "give true or false");
    return small == "true";
}

void text_table::refuse(std::size_t row, std::string_view why, std::string_view hint) const
{
    refuse_at(rows_[row].begin(), why, hint);
}

// Counts lines as an editor does, including line ends in quotes.
void text_table::refuse_at(std::size_t byte, std::string_view why, std::string_view hint) const
{
    unsigned line = 1;
    for (std::size_t at = 0; at < byte; at += line_end_length(text_, at))
        line += text_[at] == '\n' || text_[at] == '\r' ? 1 : 0;
    throw error(error_kind::bad_input, source_place{file_, line}, why, hint);
}

std::optional<std::size_t> text_table::cut_position() const noexcept
{
    return cut_ ? std::optional(rows_.back().begin()) : std::nullopt;
}

void text_table::refuse_cut(std::string_view hint) const
{
    refuse(rows(), "the last line is incomplete", hint);
}

std::string text_table::line(const named_cells& cells) const
{
    std::string text;
    for (const std::string& column : columns_) {
        const auto named = std::ranges::find(cells, column, &named_cells::value_type::first);
        text += named == cells.end() ? "n/a" : format_table_cell(named->second);
        text += &column == &columns_.back() ? line_end_ : "\t";
    }
    return text;
}

std::string text_table::missing_end() const
{
    if (text_.ends_with('\n') || text_.ends_with('\r'))
        return {};
    const auto has_no_byte = [](const table_cell& c) { return c.begin == c.end; }; // false for a quoted cell
    const bool empty =
        is_open() && rows_.back().end() == text_.size() && has_no_byte(rows_.back().cells.back());
    return (empty ? "n/a" : "") + line_end_;
}

std::string text_table::text_with_cells(std::size_t row, const named_cells& cells) const
{
    std::string text = text_;
    const std::vector<table_cell>& old = rows_[row].cells;
    for (std::size_t i = old.size(); i-- > 0;) // backwards, so that earlier positions stay valid
        for (const auto& [column, value] : cells)
            if (columns_[i] == column)
                text.replace(old[i].begin, old[i].end - old[i].begin, format_table_cell(value));
    return text;
}

} // namespace tactor::study
