// SPDX-License-Identifier: MIT
// The module that paints with Cairo.
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <numbers>

#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "plot/paint/output.hpp"
#include "plot/paint/painter_module.hpp"

namespace tactor::plot {
namespace {

using surface_ptr = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

constexpr double halo_width = 1.6; // the same in SVG

void set_colour(cairo_t* cr, colour c)
{
    cairo_set_source_rgba(cr, c.r / 255.0, c.g / 255.0, c.b / 255.0, c.alpha);
}

class painter {
public:
    explicit painter(cairo_t* cr) : cr_(cr) { cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND); }

    void operator()(const item::group_begin&) const {}
    void operator()(const item::group_end&) const {}
    void operator()(const item::line& l) const
    {
        cairo_move_to(cr_, l.from.x, l.from.y);
        cairo_line_to(cr_, l.to.x, l.to.y);
        paint_path(l.s);
    }
    void operator()(const item::poly& p) const
    {
        for (const spot& s : p.points)
            cairo_line_to(cr_, s.x, s.y);
        if (p.closed)
            cairo_close_path(cr_);
        paint_path(p.s);
    }
    void operator()(const item::rect& r) const
    {
        cairo_rectangle(cr_, r.b.x, r.b.y, r.b.width, r.b.height);
        paint_path(r.s);
    }
    void operator()(const item::circle& o) const
    {
        if (o.moves)
            return;
        cairo_new_sub_path(cr_);
        cairo_arc(cr_, o.centre.x, o.centre.y, o.radius, 0.0, 2.0 * std::numbers::pi);
        cairo_close_path(cr_);
        paint_path(o.s);
    }
    void operator()(const item::text& t) const
    {
        const std::string s = clean(t.string);
        cairo_select_font_face(cr_, typeface, CAIRO_FONT_SLANT_NORMAL,
                               t.s.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
        cairo_set_font_size(cr_, t.s.size);
        cairo_text_extents_t e;
        cairo_text_extents(cr_, s.c_str(), &e);
        const double part = t.s.anchor == align::start ? 0.0 : t.s.anchor == align::middle ? 0.5 : 1.0;
        cairo_save(cr_);
        cairo_translate(cr_, t.at.x, t.at.y);
        if (t.s.upwards)
            cairo_rotate(cr_, -std::numbers::pi / 2.0);
        cairo_move_to(cr_, -part * e.x_advance, 0.0);
        if (t.s.halo) {
            cairo_text_path(cr_, s.c_str());
            cairo_set_line_width(cr_, halo_width);
            set_colour(cr_, white);
            cairo_stroke(cr_);
            cairo_move_to(cr_, -part * e.x_advance, 0.0);
        }
        set_colour(cr_, t.s.ink);
        cairo_show_text(cr_, s.c_str());
        cairo_new_path(cr_);
        cairo_restore(cr_);
    }

private:
    void paint_path(const style& s) const
    {
        if (s.fill) {
            set_colour(cr_, *s.fill);
            cairo_fill_preserve(cr_);
        }
        if (s.stroke) {
            set_colour(cr_, *s.stroke);
            cairo_set_line_width(cr_, s.width);
            cairo_set_dash(cr_, &s.dash, s.dash > 0.0 ? 1 : 0, 0.0);
            cairo_stroke_preserve(cr_);
        }
        cairo_new_path(cr_);
    }

    cairo_t* cr_;
};

// Throws error (runtime) unless the status is success.
void check(cairo_status_t status)
{
    if (status != CAIRO_STATUS_SUCCESS)
        throw error(error_kind::runtime, "picture", cairo_status_to_string(status));
}

// Paints on white; `scale`: units of the surface for each point.
// \throws error (runtime).
void paint(const canvas& c, cairo_surface_t* surface, double scale)
{
    check(cairo_surface_status(surface));
    const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cr(cairo_create(surface), &cairo_destroy);
    check(cairo_status(cr.get()));
    // Metrics without hinting: text is as wide on every device.
    const std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)> fonts(
        cairo_font_options_create(), &cairo_font_options_destroy);
    cairo_font_options_set_hint_metrics(fonts.get(), CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_hint_style(fonts.get(), CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_antialias(fonts.get(), CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr.get(), fonts.get());
    cairo_scale(cr.get(), scale, scale);
    set_colour(cr.get(), white);
    cairo_paint(cr.get());
    for (const canvas::element& e : c.elements)
        std::visit(painter(cr.get()), e);
    check(cairo_status(cr.get()));
}

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

// Adds the size of a pixel and the mark in chunks after the header (8 + 25 bytes): Cairo writes neither.
void add_resolution_and_mark(std::string& png, unsigned dpi)
{
    constexpr std::size_t after_header = 33;
    const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
    std::string resolution = "pHYs";
    add_big_endian(resolution, per_metre);
    add_big_endian(resolution, per_metre);
    resolution += '\1';
    png.insert(after_header, make_chunk(resolution) + make_chunk(std::string(png_mark)));
}

// Adds the mark as a comment before "startxref", so that no reference moves.
void add_mark(std::string& pdf)
{
    const std::size_t at = pdf.rfind("\nstartxref");
    if (at != std::string::npos)
        pdf.replace(at, std::string_view("\nstartxref").size(), pdf_mark);
}

template <typename F>
painting painted(F bytes) noexcept
{
    try {
        return {.bytes = bytes()};
    } catch (const error& e) {
        return {.failed = e.kind(),
                .what = std::string(e.subject()),
                .why = std::string(e.why()),
                .hint = std::string(e.hint())};
    } catch (const std::bad_alloc&) {
        return {.no_memory = true};
    }
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
                    "use fewer dpi or a smaller --width, or SVG or PDF");
    const surface_ptr surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)),
        &cairo_surface_destroy);
    paint(c, surface.get(), scale);
    std::string png;
    check(cairo_surface_write_to_png_stream(surface.get(), append, &png));
    add_resolution_and_mark(png, dpi);
    return png;
}

std::string to_pdf(const canvas& c)
{
    std::string pdf;
    const surface_ptr surface(cairo_pdf_surface_create_for_stream(append, &pdf, c.width, c.height),
                              &cairo_surface_destroy);
    cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_5);
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, clean(c.title).c_str());
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_SUBJECT, clean(c.description).c_str());
    // Without this Cairo writes the time: the same picture must be the same file.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
    paint(c, surface.get(), 1.0);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
    add_mark(pdf);
    return pdf;
}

extern "C" __attribute__((visibility("default"))) const painter_module tactor_painter{
    [](const canvas& c, unsigned dpi) noexcept { return painted([&] { return to_png(c, dpi); }); },
    [](const canvas& c) noexcept { return painted([&] { return to_pdf(c); }); }};

} // namespace tactor::plot
