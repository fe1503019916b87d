// SPDX-License-Identifier: MIT
/// \file
/// Reading what lies in a study's folder: whole files, and tables with tabs between, as tactor, spreadsheets,
/// R and pandas write them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/error.hpp>

namespace tactor::study {

struct table_cell {
    std::string text = {}; ///< without quotes
    bool quoted = false;
    std::size_t begin = 0; ///< in the file's text, with quotes
    std::size_t end = 0;

    /// True for n/a, for an empty cell and for R's NA.
    bool missing() const noexcept { return text.empty() || text == "n/a" || (text == "NA" && !quoted); }
};

struct table_line {
    std::vector<table_cell> cells = {};
    bool ended = false; ///< by a line end

    std::size_t begin() const noexcept { return cells.front().begin; }
    std::size_t end() const noexcept { return cells.back().end; }
};

/// Returns the bytes of a regular file; refuses a pipe or a device in a study's folder without waiting for
/// it. \throws error (bad_input) naming it.
std::string read_file(const std::filesystem::path& file);

/// Returns true if something of a study is there. \throws error (bad_input) for what is there and cannot be
/// reached, because it would count as data that never were: a link to nothing, a folder that may not be
/// searched, a part of the path that is no folder.
bool is_there(const std::filesystem::path& study, const std::filesystem::path& below);

/// Cells by the names of their columns.
using named_cells = std::vector<std::pair<std::string_view, std::string>>;

/// Returns the first line of a new table with these columns.
std::string header_line(const named_cells& cells);

/// Says whether a table's last line may be one that a crash cut off.
enum class last_line { whole, may_be_cut };

/// A table with a header line, as tactor writes it and other programs save it. Lines end in LF, CR LF or CR;
/// blank ones, tabs alone too, are left out, as are a byte order mark and empty cells after a line's last. A
/// cell in quotes may have tabs and line ends, and two quotes for one.
class text_table {
public:
    /// \throws error (bad_input) with file and line: UTF-16 or another kind of file, commas or other
    /// separators in place of tabs, no header, a column without a name or there twice, a line with too many
    /// or too few cells.
    explicit text_table(const std::filesystem::path& file, last_line end = last_line::whole);
    /// The same of a text; `file` names it in messages.
    text_table(const std::filesystem::path& file, std::string text, last_line end = last_line::whole);

    std::size_t rows() const noexcept { return rows_.size() - (cut_ ? 1 : 0); }
    const std::vector<std::string>& columns() const noexcept { return columns_; }
    bool has(std::string_view column) const { return find(column).has_value(); }
    /// \throws error (bad_input) where there is no such column, with rows or without.
    void need_column(std::string_view column) const;
    /// A cell, or nothing for n/a. \throws error (bad_input) where there is no such column.
    std::optional<std::string_view> cell(std::size_t row, std::string_view column) const;
    /// The same of what must be there.
    std::string_view need(std::size_t row, std::string_view column) const;
    /// A whole number, also as 3.0. \throws error (bad_input) for what is none, or below `least` or above
    /// `most`.
    std::optional<unsigned> whole(std::size_t row, std::string_view column, unsigned least,
                                  unsigned most) const;
    /// A finite number.
    std::optional<double> number(std::size_t row, std::string_view column) const;
    /// True or false, in capitals or not; it must be there.
    bool truth(std::size_t row, std::string_view column) const;
    /// Refuses a row, naming its line.
    [[noreturn]] void refuse(std::size_t row, std::string_view why, std::string_view hint = {}) const;

    const std::string& file() const noexcept { return file_; }

    /// True where no line end follows the last row.
    bool is_open() const noexcept { return !rows_.empty() && !cut_ && !rows_.back().ended; }
    /// Takes the last row for one that is cut off.
    void leave_out_last() noexcept { cut_ = true; }
    /// The byte at which a line begins that is cut off; it is none of the rows.
    std::optional<std::size_t> cut_at() const noexcept;
    /// Refuses the line that is cut off. There is one.
    [[noreturn]] void refuse_cut(std::string_view hint) const;

    /// Returns a line with its end: n/a where nothing is named, and no column that is not there.
    std::string line(const named_cells& cells) const;
    /// Returns what the file's last line lacks before another one can follow: mostly nothing.
    std::string missing_end() const;
    /// Returns the file's text with a line at its end.
    std::string with_line(const named_cells& cells) const { return text_ + missing_end() + line(cells); }
    /// Returns the file's text with these cells of a row changed, the others as they are.
    std::string with_cells(std::size_t row, const named_cells& cells) const;

private:
    std::optional<std::size_t> find(std::string_view column) const;
    void take_header(table_line line);
    void take_row(table_line line, bool may_be_cut);
    [[noreturn]] void refuse_at(std::size_t byte, std::string_view why, std::string_view hint) const;

    std::string file_;
    std::string text_;
    std::string line_end_ = "\n"; ///< as the header has it
    std::vector<std::string> columns_;
    std::vector<table_line> rows_;
    bool cut_ = false; ///< the last of them is cut off
};

} // namespace tactor::study
