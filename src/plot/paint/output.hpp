// SPDX-License-Identifier: MIT
/// \file
/// Pictures as files: SVG, PNG and PDF. The same picture always gives the same bytes, independent of locale
/// and time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

enum class file_format { svg, png, pdf };

/// Returns the format for a file's extension. Ignores case. \throws error (bad_input) that lists the three
/// formats.
file_format find_format(const std::filesystem::path& file);

/// Texts by which tactor recognises its own pictures. They are near the beginning of a file, but at the end
/// of a PDF.
inline constexpr std::string_view svg_mark = "?>\n<!-- Drawn by tactor -->\n<svg ";
inline constexpr std::string_view png_mark = std::string_view("tEXtSoftware\0tactor", 19);
inline constexpr std::string_view pdf_mark = "\n% Drawn by tactor\nstartxref";

inline constexpr unsigned least_dpi = 30;
inline constexpr unsigned most_dpi = 2400;

/// Appends a number in the byte order of PNG.
void add_big_endian(std::string& s, std::uint32_t v);
/// Returns a chunk of a PNG, with length and CRC.
std::string make_chunk(const std::string& name_and_content);

/// Returns the picture as an SVG document. Texts stay texts. Each group has the id, title and desc of its
/// mark.
std::string to_svg(const canvas& c);

/// Returns the picture as a PNG in 8-bit RGB on white, with its resolution.
/// \throws error: bad_input for too many pixels, runtime if rsvg-convert is missing or fails.
std::string to_png(const canvas& c, unsigned dpi);

/// Returns the picture as a PDF with one page of the same size. \throws error (runtime) as to_png() does.
std::string to_pdf(const canvas& c);

/// Returns the picture as the bytes of a file. `dpi` is only for PNG. \throws error as to_png() does.
std::string to_bytes(const canvas& c, file_format format, unsigned dpi);

/// Default resolution of PNG.
inline constexpr unsigned usual_dpi = 300;

/// Checks whether save() could replace an existing file. Call it after all input has been read and before
/// long work.
/// \throws error (bad_input).
void check_output(const std::filesystem::path& file, bool force);

/// Writes a picture. The format follows from the file's name; `dpi` is only for PNG. Writes a temporary file
/// in the same folder and renames it, so that there is never an incomplete file. Blocks on the file system.
/// \throws error: bad_input for an unknown extension, a folder that does not exist, or a file that was read
///         as input; without `force` also for an existing file that is not an unchanged picture of tactor;
///         runtime for a failure of the file system.
void save(const canvas& c, const std::filesystem::path& file, unsigned dpi, bool force);

} // namespace tactor::plot
