// SPDX-License-Identifier: MIT
#include "plot/paint/cairo_painter.hpp"

#include <numbers>

#include <tactor/error.hpp>

#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double halo_width = 1.6; // as in SVG

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

} // namespace

void check(cairo_status_t status)
{
    if (status != CAIRO_STATUS_SUCCESS)
        throw error(error_kind::runtime, "picture", cairo_status_to_string(status));
}

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

} // namespace tactor::plot
