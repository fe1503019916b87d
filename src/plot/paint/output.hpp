// SPDX-License-Identifier: MIT
/// \file
/// Pictures as files: SVG, PNG and PDF. The same picture gives the same bytes, in every locale and at any
/// time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

enum class file_format { svg, png, pdf };

/// Returns the format of an extension, in upper or lower case. \throws error (bad_input) that lists the
/// three.
file_format find_format(const std::filesystem::path& file);

/// Marks of tactor's pictures: near the beginning, in a PDF at the end.
inline constexpr std::string_view svg_mark = "?>\n<!-- Drawn by tactor -->\n<svg ";
inline constexpr std::string_view png_mark = std::string_view("tEXtSoftware\0tactor", 19);
inline constexpr std::string_view pdf_mark = "\n% Drawn by tactor\nstartxref";

inline constexpr unsigned least_dpi = 30;
inline constexpr unsigned most_dpi = 2400;

/// Adds a number of a PNG.
void add_big_endian(std::string& s, std::uint32_t v);
/// Returns a chunk of a PNG, with its length and its CRC.
std::string make_chunk(const std::string& name_and_content);

/// Returns an SVG document: real text, a group for each mark with an id, title and desc.
std::string to_svg(const canvas& c);

/// Returns an image in 8-bit RGB on white, with its resolution. \throws error: bad_input for more pixels than
/// an image may have, runtime if rsvg-convert is missing or fails.
std::string to_png(const canvas& c, unsigned dpi);

/// Returns a page of the picture's size. \throws error (runtime) as to_png().
std::string to_pdf(const canvas& c);

/// Returns the bytes of a file in a format; `dpi` is for PNG. \throws error as above.
std::string to_bytes(const canvas& c, file_format format, unsigned dpi);

/// Resolution of PNG by default.
inline constexpr unsigned usual_dpi = 300;

/// Throws the error that save() would throw about an existing file. Call it when all input is read, before
/// the work. \throws error (bad_input).
void check_output(const std::filesystem::path& file, bool force);

/// Writes a picture in the format of the name; `dpi` is for PNG. Writes under a temporary name in the same
/// folder, then renames: no incomplete file is left. Blocks on the file system. \throws error: bad_input
/// for the extension, a folder that does not exist, a file that was read as input or, without `force`, one
/// that is not a picture of tactor as save() wrote it; runtime for failures of the file system.
void save(const canvas& c, const std::filesystem::path& file, unsigned dpi, bool force);

} // namespace tactor::plot
