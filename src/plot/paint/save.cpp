// SPDX-License-Identifier: MIT
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "files/output_file.hpp"
#include "plot/paint/output.hpp"

namespace tactor::plot {

namespace fs = std::filesystem;

file_format format_of(const fs::path& file)
{
    const std::string e = in_small_letters(file.extension().string());
    if (e == ".svg")
        return file_format::svg;
    if (e == ".png")
        return file_format::png;
    if (e == ".pdf")
        return file_format::pdf;
    throw error(error_kind::bad_input, file.string(),
                e.empty() ? "has no extension, so it is not said which format the picture has"
                          : fmt::format("\"{}\" is no format for a picture", e),
                e.empty() && file.string().starts_with("/dev/")
                    ? "its name says which: write FILE.svg, .png or .pdf, and pass that on"
                    : "end the name in .svg, .png or .pdf");
}

void check_output(const fs::path& file, bool force)
{
    const file_format format = format_of(file);
    detail::check_replaced(file, force, [format](std::string_view begin, std::string_view end) {
        return format == file_format::pdf   ? end.find(pdf_mark) != end.npos
               : format == file_format::png ? begin.find(png_mark) != begin.npos
                                            : begin.find(svg_mark) != begin.npos;
    });
}

void save(const canvas& c, const fs::path& file, unsigned dpi, bool force)
{
    check_output(file, force);
    const file_format format = format_of(file);
    const std::string bytes = format == file_format::svg   ? to_svg(c)
                              : format == file_format::png ? to_png(c, dpi)
                                                           : to_pdf(c);
    detail::output_file to(file);
    to.write(bytes.data(), static_cast<std::int64_t>(bytes.size()));
    to.commit();
}

} // namespace tactor::plot
