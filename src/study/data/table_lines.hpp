// SPDX-License-Identifier: MIT
/// \file
/// Lines and cells of a table with tabs, as tactor, spreadsheets, R and pandas write them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

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
    std::size_t number = 1; ///< in the file, from 1
    std::vector<table_cell> cells = {};
    bool ended = false; ///< by a line end

    std::size_t begin() const noexcept { return cells.front().begin; }
    std::size_t end() const noexcept { return cells.back().end; }
};

/// Splits a text, from a byte on. Lines end in LF, CR LF or CR; blank ones, tabs alone too, are left out. A
/// cell in quotes may have tabs and line ends, and two quotes for one.
std::vector<table_line> split_table(std::string_view text, std::size_t from);

/// Returns the cell as it is written: in quotes where it would be read as another.
std::string written_cell(std::string_view text);

/// Tests for UTF-8 without bytes of 0.
bool is_plain_text(std::string_view text) noexcept;

} // namespace tactor::study
