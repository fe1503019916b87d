// SPDX-License-Identifier: MIT
/// \file
/// Pictures as files: SVG, PNG and PDF. The same picture gives the same bytes, in every locale and at any
/// time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

enum class file_format { svg, png, pdf };

/// By the extension, in upper or lower case. \throws error (bad_input) that lists the three.
file_format format_of(const std::filesystem::path& file);

/// Marks of tactor's own pictures: near the beginning, in a PDF at the end.
inline constexpr std::string_view svg_mark = "?>\n<!-- Drawn by tactor -->\n<svg ";
inline constexpr std::string_view png_mark = std::string_view("tEXtSoftware\0tactor", 19);
inline constexpr std::string_view pdf_mark = "\n% Drawn by tactor\nstartxref";

inline constexpr unsigned least_dpi = 30;
inline constexpr unsigned most_dpi = 2400;

/// An SVG document: real text, a group with an id for each thing that has one, title and desc.
std::string to_svg(const canvas& c);

/// 8-bit RGB on white that says its resolution. \throws error: bad_input for more pixels than an image may
/// have,
///         runtime for a failure of the drawing library.
std::string to_png(const canvas& c, unsigned dpi);

/// One page of the picture's size. \throws error (runtime).
std::string to_pdf(const canvas& c);

/// Throws what save() would throw about the file that is there. To be called when all input is read, before
/// the work. \throws error (bad_input).
void check_output(const std::filesystem::path& file, bool force);

/// Writes a picture in the format of the name; `dpi` is for PNG. It is written under a temporary name in the
/// same folder, then renamed: nothing incomplete is left. Blocks on the file system. \throws error: bad_input
/// for the extension, a folder that does not exist, a file that was read as input or, without `force`, one
/// that is not a picture of tactor; runtime for what the file system refuses.
void save(const canvas& c, const std::filesystem::path& file, unsigned dpi, bool force);

} // namespace tactor::plot
