// SPDX-License-Identifier: MIT
/// \file
/// Formats of stroke files. A format is a file with its reader and a stroke_format, and a row in
/// stroke/formats.cpp; everything else that lists formats reads stroke_formats().
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/output_file.hpp"

namespace tactor::detail {

/// Text of a stroke file, and what its reader needs besides.
struct stroke_file_text {
    std::string_view text;
    const std::string& name;                       ///< stands for the text in messages
    double intensity_max = 1.0;                    ///< value of an intensity that means 1
    const std::filesystem::path* folder = nullptr; ///< of files that it names; null: it must not name any
    std::string_view position = {};                ///< place on the body; empty: the first in the text
    const actuator_numbers* actuator = nullptr;    ///< of vibrations; null: that of the format
};

/// A format of stroke files.
struct stroke_format {
    std::string_view name;  ///< parameter of the service, and extension of the files that it writes
    std::string_view title; ///< for people
    std::span<const std::string_view> extensions; ///< with the dot, lower case; the first is for new files
    std::string_view media_type;
    /// Returns true for a text whose content shows this format.
    bool (*begins)(std::string_view text);
    /// Reads a text. \throws error (bad_input) with line and column.
    std::vector<stroke> (*parse)(const stroke_file_text& s);
    /// Returns the text of a file; null: the format is only read. \throws error (bad_input) for strokes that
    /// it cannot hold.
    std::string (*write)(std::span<const stroke> strokes) = nullptr;
    /// A file has the points of one stroke: no second stroke, and no options.
    bool only_points = false;
    bool has_positions = false; ///< a file may have touches for several places on the body
    /// A start may count from the start or end of the stroke before.
    bool starts_from_strokes = false;
    comment_marks comment = {"# ", ""};
};

/// Reads a text. \throws error (bad_input), also for a position that the format does not have.
std::vector<stroke> read_stroke_text(const stroke_format& f, const stroke_file_text& s);

/// Reads a file, as load_strokes() does. \throws error (bad_input).
std::vector<stroke> load_stroke_file(const std::filesystem::path& file, double intensity_max,
                                     std::string_view position, const actuator_numbers* actuator);

/// Returns all formats. The first, TOML, is for texts of no known format: its reader explains the fault.
std::span<const stroke_format* const> stroke_formats() noexcept;

/// Returns the format with this name; null for none.
const stroke_format* find_format_by_name(std::string_view name) noexcept;

/// Returns the format that has the extension of this file, in upper or lower case; null for none.
const stroke_format* find_format_by_extension(const std::filesystem::path& file);

/// Returns the format that the content of a text shows; null for none.
const stroke_format* find_format_by_content(std::string_view text);

/// Returns the format of a text with strokes: by the extension of its file, else by its content, else TOML.
const stroke_format* find_stroke_format(std::string_view text, const std::filesystem::path& file);

/// Returns "TOML, CSV, SVG, TACT, HAPTIC or AHAP": the titles of all formats.
std::string list_stroke_formats();

} // namespace tactor::detail
