// SPDX-License-Identifier: MIT
/// \file
/// Reading what lies in a study's folder: whole files, and tables with tabs between.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>

namespace tactor::study {

/// A trial is a line of some 200 bytes: more than this is no table of ours.
inline constexpr std::size_t most_bytes = std::size_t{64} << 20;

/// The bytes of a regular file; a pipe or a device in a study's folder is refused, not waited for.
/// \throws error (bad_input) naming it.
std::string read_file(const std::filesystem::path& file, std::size_t most = most_bytes);

/// Whether something of a study is there. \throws error (bad_input) for what is there and cannot be reached:
/// a link to nothing, a folder that may not be searched, a part of the path that is no folder. It would be
/// taken for data that never were.
bool is_there(const std::filesystem::path& study, const std::filesystem::path& below);

/// What is in a folder, in no order. \throws error (bad_input) where it cannot be read.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);

/// A table with a header line. "n/a" is a value that is not there.
class text_table {
public:
    /// Lines may end in CR LF. \throws error (bad_input) with file and line: no header, a column that is
    /// there twice, an empty cell, a line with too many or too few, an end without a line end.
    explicit text_table(const std::filesystem::path& file);

    std::size_t rows() const noexcept { return cells_.size(); }
    bool has(std::string_view column) const { return find(column).has_value(); }
    /// A cell, or nothing for n/a. \throws error (bad_input) where there is no such column.
    std::optional<std::string_view> cell(std::size_t row, std::string_view column) const;
    /// The same of what must be there.
    std::string_view need(std::size_t row, std::string_view column) const;
    /// A whole number. \throws error (bad_input) for what is none, or below `least` or above `most`.
    std::optional<unsigned> whole(std::size_t row, std::string_view column, unsigned least,
                                  unsigned most) const;
    /// A finite number.
    std::optional<double> number(std::size_t row, std::string_view column) const;
    /// Refuses a row, naming its line.
    [[noreturn]] void refuse(std::size_t row, std::string_view why, std::string_view hint = {}) const;

    const std::string& file() const noexcept { return file_; }

private:
    std::optional<std::size_t> find(std::string_view column) const;

    std::string file_;
    std::string text_;
    std::vector<std::string_view> columns_; ///< into text_
    std::vector<std::vector<std::string_view>> cells_;
};

} // namespace tactor::study
