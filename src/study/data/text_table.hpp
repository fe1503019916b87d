// SPDX-License-Identifier: MIT
/// \file
/// Reads the files in a study's folder: whole files, and tables with tabs between the cells, as tactor,
/// spreadsheets, R and pandas write them.
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
    std::size_t begin = 0; ///< position of the first byte in the file's text; includes an opening quote
    std::size_t end = 0;

    /// Returns true for n/a, for an empty cell and for R's NA.
    bool missing() const noexcept { return text.empty() || text == "n/a" || (text == "NA" && !quoted); }
};

struct table_line {
    std::vector<table_cell> cells = {};
    bool ended = false; ///< true if a line end follows

    std::size_t begin() const noexcept { return cells.front().begin; }
    std::size_t end() const noexcept { return cells.back().end; }
};

/// Returns the bytes of a regular file. \throws error (bad_input) with the file's name if it cannot be read.
/// Refuses pipes and devices, because reading them could block.
std::string read_file(const std::filesystem::path& file);

/// Returns true if the path `below` exists in the folder `study`. \throws error (bad_input) if the path
/// cannot be followed: it has a broken link, a folder without permission, or a file in place of a folder.
/// Otherwise the analysis would silently skip recorded data.
bool exists_in_study(const std::filesystem::path& study, const std::filesystem::path& below);

/// Cells with the names of their columns.
using named_cells = std::vector<std::pair<std::string_view, std::string>>;

/// Returns the first line of a new table with these columns.
std::string header_line(const named_cells& cells);

/// State of a table's last line: whole, or perhaps cut off by a crash.
enum class last_line { whole, may_be_cut };

/// A table with a header line, as tactor writes it and other programs save it. Lines end in LF, CR LF or CR.
/// The reader skips a byte order mark, lines that are blank or have only tabs, and empty cells beyond the
/// last column. A cell in quotes may contain tabs and line ends; two quotes inside stand for one quote.
class text_table {
public:
    /// Reads a file. \throws error (bad_input) with file and line for UTF-16 or a file that is not text,
    /// separators other than tabs, a missing header, a column without a name, two columns with one name, or a
    /// line with too many or too few cells.
    explicit text_table(const std::filesystem::path& file, last_line end = last_line::whole);
    /// Reads a text in the same way. `file`: name of the text in messages.
    text_table(const std::filesystem::path& file, std::string text, last_line end = last_line::whole);

    std::size_t rows() const noexcept { return rows_.size() - (cut_ ? 1 : 0); }
    const std::vector<std::string>& columns() const noexcept { return columns_; }
    bool has(std::string_view column) const { return find(column).has_value(); }
    /// Throws error (bad_input) if the column is missing, even if the table has no rows.
    void need_column(std::string_view column) const;
    /// Returns a cell's text, or nothing for n/a. \throws error (bad_input) if the column is missing.
    std::optional<std::string_view> cell(std::size_t row, std::string_view column) const;
    /// Returns a cell's text. \throws error (bad_input) if the column is missing or the cell is n/a.
    std::string_view need(std::size_t row, std::string_view column) const;
    /// Returns a whole number, which may be written as 3.0, or nothing for n/a. \throws error (bad_input) for
    /// other texts, and for a number below `least` or above `most`.
    std::optional<unsigned> whole(std::size_t row, std::string_view column, unsigned least,
                                  unsigned most) const;
    /// Returns a finite number, or nothing for n/a. \throws error (bad_input) for other texts.
    std::optional<double> number(std::size_t row, std::string_view column) const;
    /// Reads true or false in small or capital letters. \throws error (bad_input) for other texts and n/a.
    bool truth(std::size_t row, std::string_view column) const;
    /// Throws error (bad_input) with the line of a row.
    [[noreturn]] void refuse(std::size_t row, std::string_view why, std::string_view hint = {}) const;

    const std::string& file() const noexcept { return file_; }

    /// Returns true if no line end follows the last row.
    bool is_open() const noexcept { return !rows_.empty() && !cut_ && !rows_.back().ended; }
    /// Marks the last row as cut off, so that rows() no longer counts it.
    void drop_last_row() noexcept { cut_ = true; }
    /// Returns the position of the last line's first byte if that line is cut off, else nothing. rows() does
    /// not count a line that is cut off.
    std::optional<std::size_t> cut_position() const noexcept;
    /// Throws error (bad_input) with the line that is cut off. \pre cut_position() has a value.
    [[noreturn]] void refuse_cut(std::string_view hint) const;

    /// Returns a new line with its line end. Columns without a cell in `cells` are n/a; cells for columns
    /// that the table lacks are left out.
    std::string line(const named_cells& cells) const;
    /// Returns the text that completes the file's last line, so that another line can follow; usually empty.
    std::string missing_end() const;
    /// Returns the file's text with a new line added.
    std::string text_with_line(const named_cells& cells) const { return text_ + missing_end() + line(cells); }
    /// Returns the file's text with these cells of one row changed.
    std::string text_with_cells(std::size_t row, const named_cells& cells) const;

private:
    std::optional<std::size_t> find(std::string_view column) const;
    void take_header(table_line line);
    void take_row(table_line line, bool may_be_cut);
    [[noreturn]] void refuse_at(std::size_t byte, std::string_view why, std::string_view hint) const;

    std::string file_;
    std::string text_;
    std::string line_end_ = "\n"; ///< line end of the header
    std::vector<std::string> columns_;
    std::vector<table_line> rows_;
    bool cut_ = false; ///< true if the last row is cut off
};

} // namespace tactor::study
