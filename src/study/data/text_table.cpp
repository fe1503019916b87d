// SPDX-License-Identifier: MIT
#include "study/data/text_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/split.hpp"
#include "files/text_file.hpp"

namespace tactor::study {
namespace {

[[noreturn]] void refuse_line(const std::string& file, std::size_t line, std::string_view why,
                              std::string_view hint)
{
    throw error(error_kind::bad_input, source_place{file, static_cast<unsigned>(line)}, why, hint);
}

void check_cells(const std::string& file, std::size_t line, const std::vector<std::string_view>& cells,
                 std::size_t columns)
{
    if (cells.size() != columns)
        refuse_line(file, line, fmt::format("it has {} columns, not {}", cells.size(), columns),
                    "there is a tab between two of them, and n/a where there is no value");
    for (const std::string_view c : cells)
        if (c.empty() || c.find('\0') != std::string_view::npos)
            refuse_line(file, line, "a cell is empty", "n/a where there is no value");
}

} // namespace

std::string read_file(const std::filesystem::path& file, std::size_t most)
{
    std::error_code failed;
    const std::filesystem::file_status s = std::filesystem::status(file, failed);
    if (!std::filesystem::exists(s))
        throw error(error_kind::bad_input, file.string(),
                    failed ? failed.message() : "No such file or directory",
                    "the folder of a study is what tactor experiment wrote");
    if (!std::filesystem::is_regular_file(s))
        throw error(error_kind::bad_input, file.string(), "it is no file",
                    "the folder of a study has files only");
    return std::string(std::string_view(detail::read_text_file(file, most, detail::owner_kind::program)));
}

bool is_there(const std::filesystem::path& study, const std::filesystem::path& below)
{
    namespace fs = std::filesystem;
    fs::path at = study;
    const auto refuse = [&at](std::string_view why) {
        throw error(error_kind::bad_input, at.string(), why,
                    "mend it, or leave its participant out with --exclude");
    };
    const auto kind_of = [&refuse](const fs::path& p, auto ask) {
        std::error_code failed;
        const fs::file_status s = ask(p, failed);
        if (failed && s.type() != fs::file_type::not_found)
            refuse(failed.message());
        return s.type();
    };
    using ask = fs::file_status (*)(const fs::path&, std::error_code&);
    for (const fs::path& part : below) {
        if (at != study && kind_of(at, static_cast<ask>(fs::status)) != fs::file_type::directory)
            refuse("it is no folder");
        at /= part;
        if (kind_of(at, static_cast<ask>(fs::symlink_status)) == fs::file_type::not_found)
            return false;
        if (kind_of(at, static_cast<ask>(fs::status)) == fs::file_type::not_found)
            refuse("it is a link to nothing");
    }
    return true;
}

std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> all;
    std::error_code failed;
    for (std::filesystem::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed))
        all.push_back(i->path());
    if (failed)
        throw error(error_kind::bad_input, folder.string(), failed.message(),
                    "it must be readable as a whole");
    return all;
}

text_table::text_table(const std::filesystem::path& file) : file_(file.string()), text_(read_file(file))
{
    std::string_view rest = text_;
    if (rest.starts_with("\xef\xbb\xbf"))
        rest.remove_prefix(3);
    if (rest.empty())
        throw error(error_kind::bad_input, file_, "it is empty", "the first line names the columns");
    std::size_t line = 0;
    while (!rest.empty()) {
        ++line;
        const std::size_t end = rest.find('\n');
        if (end == std::string_view::npos)
            refuse_line(file_, line, "the last line has no end",
                        "it was cut off in the middle; tactor experiment --resume mends that");
        std::string_view text = rest.substr(0, end);
        rest.remove_prefix(end + 1);
        if (text.ends_with('\r'))
            text.remove_suffix(1);
        std::vector<std::string_view> cells = detail::split(text, '\t');
        check_cells(file_, line, cells, line == 1 ? cells.size() : columns_.size());
        if (line > 1) {
            cells_.push_back(std::move(cells));
            continue;
        }
        columns_ = std::move(cells);
        for (std::size_t i = 0; i < columns_.size(); ++i)
            if (std::find(columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(i), columns_[i]) !=
                columns_.begin() + static_cast<std::ptrdiff_t>(i))
                refuse_line(file_, 1, fmt::format("the column {} is there twice", columns_[i]),
                            "each has a name of its own");
    }
}

std::optional<std::size_t> text_table::find(std::string_view column) const
{
    const auto at = std::find(columns_.begin(), columns_.end(), column);
    return at == columns_.end() ? std::nullopt
                                : std::optional(static_cast<std::size_t>(at - columns_.begin()));
}

std::optional<std::string_view> text_table::cell(std::size_t row, std::string_view column) const
{
    const auto at = find(column);
    if (!at)
        refuse_line(file_, 1, fmt::format("there is no column {}", column), "tactor-analyze(1) lists them");
    const std::string_view text = cells_[row][*at];
    return text == "n/a" ? std::nullopt : std::optional(text);
}

std::string_view text_table::need(std::size_t row, std::string_view column) const
{
    const auto text = cell(row, column);
    if (!text)
        refuse(row, fmt::format("{} is missing", column), "n/a is not enough here");
    return *text;
}

std::optional<unsigned> text_table::whole(std::size_t row, std::string_view column, unsigned least,
                                          unsigned most) const
{
    const auto text = cell(row, column);
    if (!text)
        return {};
    unsigned v = 0;
    const auto [end, failed] = std::from_chars(text->data(), text->data() + text->size(), v);
    if (failed != std::errc() || end != text->data() + text->size() || v < least || v > most)
        refuse(row, fmt::format("{} is \"{}\"", column, *text),
               fmt::format("a whole number from {} to {}", least, most));
    return v;
}

std::optional<double> text_table::number(std::size_t row, std::string_view column) const
{
    const auto text = cell(row, column);
    if (!text)
        return {};
    double v = 0.0;
    const auto [end, failed] = std::from_chars(text->data(), text->data() + text->size(), v);
    if (failed != std::errc() || end != text->data() + text->size() || !std::isfinite(v))
        refuse(row, fmt::format("{} is \"{}\"", column, *text), "a number, or n/a");
    return v;
}

void text_table::refuse(std::size_t row, std::string_view why, std::string_view hint) const
{
    refuse_line(file_, row + 2, why, hint);
}

} // namespace tactor::study
