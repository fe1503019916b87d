// SPDX-License-Identifier: MIT
/// \file
/// Formats of stroke files. To add a format, write a file with a reader and a stroke_format, and add a row to
/// stroke/formats.cpp. All code that lists formats calls stroke_formats().
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/output_file.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

/// Text of a stroke file, and the other data that its reader needs.
struct stroke_file_text {
    std::string_view text;
    const std::string& name;                       ///< name of the text in messages
    double intensity_max = 1.0;                    ///< value in the file that means intensity 1
    const std::filesystem::path* folder = nullptr; ///< folder of named files; null: text must name none
    std::string_view position = {};                ///< place on the body; empty for the first one in the text
    const actuator_numbers* actuator = nullptr;    ///< actuator of vibrations; null for that of the format
};

/// A format of stroke files.
struct stroke_format {
    std::string_view name;                        ///< parameter of the service, and extension of new files
    std::string_view title;                       ///< name for people
    std::span<const std::string_view> extensions; ///< in lower case with the dot; new files get the first
    std::string_view media_type;
    /// Returns true if the content of a text is in this format.
    bool (*begins)(std::string_view text);
    /// Reads a text. \throws error (bad_input) with line and column.
    std::vector<stroke> (*parse)(const stroke_file_text& s);
    /// Returns the text of a file. Null if tactor can only read the format.
    /// \throws error (bad_input) for strokes that the format cannot represent.
    std::string (*write)(std::span<const stroke> strokes) = nullptr;
    /// true if a file contains only the points of a single stroke, and no options
    bool only_points = false;
    /// true if a file contains only one vibration: no places, no options and no names
    bool one_vibration = false;
    bool has_positions = false; ///< true if a file may have touches for several places on the body
    /// true if a start may be relative to the start or end of the previous stroke
    bool starts_from_strokes = false;
    comment_marks comment = {"# ", ""};      ///< empty: a file has no comments
    std::size_t most_bytes = max_tree_bytes; ///< greatest length of a text
    std::string_view shorten = right_file;   ///< hint for a longer text
};

/// Reads a text. \throws error (bad_input), also for a position that the text does not have.
std::vector<stroke> read_stroke_text(const stroke_format& f, const stroke_file_text& s);

/// Reads a file in the same way as load_strokes(). \throws error (bad_input).
std::vector<stroke> load_stroke_file(const std::filesystem::path& file, double intensity_max,
                                     std::string_view position, const actuator_numbers* actuator);

/// Returns all formats. The first, TOML, also reads texts whose format is unknown, and explains the fault.
std::span<const stroke_format* const> stroke_formats() noexcept;

/// Returns the format with this name, or null if there is none.
const stroke_format* find_format_by_name(std::string_view name) noexcept;

/// Returns the format with the extension of this file, or null if there is none. Ignores case.
const stroke_format* find_format_by_extension(const std::filesystem::path& file);

/// Returns the format that the content of a text is in, or null if no format recognises it.
const stroke_format* find_format_by_content(std::string_view text);

/// Returns the format of a text with strokes. The extension of the file decides, then the content. If both
/// are unknown, the format is TOML.
const stroke_format* find_stroke_format(std::string_view text, const std::filesystem::path& file);

/// Returns a list of the titles of all formats: "TOML, CSV, SVG, TACT, HAPTIC or AHAP".
std::string list_stroke_formats();

} // namespace tactor::detail
