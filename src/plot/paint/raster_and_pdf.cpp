// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <cairo-pdf.h>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "plot/paint/cairo_painter.hpp"
#include "plot/paint/output.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double most_pixels = 32767; // Cairo's limit to a side
constexpr double most_area = 400e6;   // 1.6 GB of memory

cairo_status_t append(void* to, const unsigned char* data, unsigned length) noexcept
{
    try {
        static_cast<std::string*>(to)->append(std::bit_cast<const char*>(data), length);
        return CAIRO_STATUS_SUCCESS;
    } catch (...) {
        return CAIRO_STATUS_NO_MEMORY;
    }
}

void add_big_endian(std::string& s, std::uint32_t v)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        s += static_cast<char>((v >> shift) & 0xFFU);
}

// CRC-32 of PNG (ISO 3309).
std::uint32_t crc(std::string_view bytes) noexcept
{
    std::uint32_t c = 0xFFFFFFFFU;
    for (const char b : bytes) {
        c ^= static_cast<unsigned char>(b);
        for (int i = 0; i < 8; ++i)
            c = (c >> 1U) ^ ((c & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    return ~c;
}

void add_chunk(std::string& to, const std::string& name_and_content)
{
    constexpr std::size_t name_bytes = 4;
    add_big_endian(to, static_cast<std::uint32_t>(name_and_content.size() - name_bytes));
    to += name_and_content;
    add_big_endian(to, crc(name_and_content));
}

// Cairo says neither how large a pixel is nor who drew it; chunks behind the header (8 + 25 bytes) do.
void add_resolution_and_mark(std::string& png, unsigned dpi)
{
    constexpr std::size_t after_header = 33;
    const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
    std::string resolution = "pHYs";
    add_big_endian(resolution, per_metre);
    add_big_endian(resolution, per_metre);
    resolution += '\1';
    std::string chunks;
    add_chunk(chunks, resolution);
    add_chunk(chunks, std::string(png_mark));
    png.insert(after_header, chunks);
}

// A comment in front of the place of the table of references: no other place moves.
void add_mark(std::string& pdf)
{
    const std::size_t at = pdf.rfind("\nstartxref");
    if (at != std::string::npos)
        pdf.replace(at, std::string_view("\nstartxref").size(), pdf_mark);
}

} // namespace

std::string to_png(const canvas& c, unsigned dpi)
{
    const double scale = dpi / 72.0;
    const double width = std::round(c.width * scale);
    const double height = std::round(c.height * scale);
    if (width > most_pixels || height > most_pixels || width * height > most_area)
        throw error(error_kind::bad_input, "--dpi",
                    fmt::format("{} dpi make {:.0f} x {:.0f} pixels", dpi, width, height),
                    "ask for fewer dpi or a smaller --width, or for SVG or PDF");
    const surface_ptr surface(cairo_image_surface_create(
        CAIRO_FORMAT_RGB24, std::max(1, static_cast<int>(width)), std::max(1, static_cast<int>(height))));
    paint(c, surface.get(), scale);
    std::string png;
    check(cairo_surface_write_to_png_stream(surface.get(), append, &png));
    add_resolution_and_mark(png, dpi);
    return png;
}

std::string to_pdf(const canvas& c)
{
    std::string pdf;
    const surface_ptr surface(cairo_pdf_surface_create_for_stream(append, &pdf, c.width, c.height));
    check(cairo_surface_status(surface.get()));
    cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_5);
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, clean(c.title).c_str());
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_SUBJECT, clean(c.description).c_str());
    // Cairo would put the time of day: the same picture must be the same file.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
    paint(c, surface.get(), 1.0);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
    add_mark(pdf);
    return pdf;
}

} // namespace tactor::plot
