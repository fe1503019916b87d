// SPDX-License-Identifier: MIT
#include "files/svg/scope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/kind_names.hpp"
#include "core/limits.hpp"
#include "core/suggest.hpp"

namespace tactor::detail {
namespace {

using pugi::xml_node;

constexpr double highest_carrier_hz = 20000.0;

easing_kind read_easing(const svg_document& doc, xml_node n, std::string_view name)
{
    if (const auto k = find_kind<easing_kind>(name))
        return *k;
    doc.fail(n, fmt::format("data-easing of {}: {}", svg_document::called(n), quoted(name)),
             "linear, in-out or minimum-jerk");
}

affine own_transform(const svg_document& doc, xml_node n, const svg_viewport& v)
{
    const auto own =
        doc.read_property(n, "transform", [&v](std::string_view t) { return parse_svg_transform(t, v); });
    if (!own)
        return {};
    if (const std::string_view box = doc.property(n, "transform-box"); !box.empty() && box != "view-box")
        doc.note(n, fmt::format("transform-box: {}", quoted(box)));
    const auto origin =
        doc.read_property(n, "transform-origin", [&v](std::string_view t) { return parse_svg_origin(t, v); });
    if (!origin)
        return *own;
    const auto moved = [](double x, double y) { return affine{1.0, 0.0, 0.0, 1.0, x, y}; };
    return moved(origin->x_mm, origin->y_mm) * *own * moved(-origin->x_mm, -origin->y_mm);
}

constexpr double no_look = std::numeric_limits<double>::quiet_NaN();

// Returns a number from 0 to 1, or a percentage of it; beyond counts as the bound, as CSS has it.
double read_opacity(std::string_view text)
{
    try {
        const svg_length l = parse_svg_length(text);
        if (l.in == svg_length::unit::mm)
            return no_look;
        return std::clamp(l.in == svg_length::unit::percent ? l.value / 100.0 : l.value, 0.0, 1.0);
    } catch (const value_fault&) {
        return no_look;
    }
}

double read_width(std::string_view text, const svg_viewport& v)
{
    try {
        const double width = parse_svg_length(text).user_units(v, svg_extent::diagonal);
        return width >= 0.0 ? width : no_look;
    } catch (const value_fault&) {
        return no_look;
    }
}

} // namespace

svg_scope svg_root_scope(const svg_document& doc)
{
    const xml_node n = doc.root();
    const auto width = doc.read(n, "width", parse_svg_length);
    const auto height = doc.read(n, "height", parse_svg_length);
    const auto box = doc.read(n, "viewBox", parse_svg_view_box);
    using unit = svg_length::unit;
    const auto has = [](const auto& l, unit u) { return l && l->in == u; };
    svg_scope s;
    if (!has(width, unit::mm) && !has(height, unit::mm)) {
        s.viewport.width = box ? box->width : has(width, unit::none) ? width->value : 100.0;
        s.viewport.height = box ? box->height : has(height, unit::none) ? height->value : 100.0;
        return s;
    }
    const auto px = [&](const auto& l) -> std::optional<double> {
        if (!l || l->in == unit::percent)
            return std::nullopt;
        if (!(l->value > 0.0))
            doc.fail(n, fmt::format("{} has no size", doc.called(n)), "width and height are more than 0");
        return l->in == unit::mm ? l->value / mm_per_px : l->value;
    };
    auto w = px(width);
    auto h = px(height);
    const double ratio = box ? box->width / box->height : 1.0;
    if (!w)
        w = *h * ratio;
    if (!h)
        h = *w / ratio;
    s.to_mm = {mm_per_px, 0.0, 0.0, mm_per_px, 0.0, 0.0};
    s.viewport = {*w, *h, 1.0 / mm_per_px};
    if (box)
        enter_svg_box(doc, n, s, *box, {}, *w, *h);
    return s;
}

void enter_svg_box(const svg_document& doc, xml_node n, svg_scope& s, const svg_view_box& box, point corner,
                   double width, double height)
{
    const auto aspect = doc.read(n, "preserveAspectRatio", parse_svg_aspect);
    s.to_mm = s.to_mm * fit(box, corner, width, height, aspect.value_or(svg_aspect{}));
    s.viewport.width = box.width;
    s.viewport.height = box.height;
}

void inherit_svg(const svg_document& doc, xml_node n, svg_scope& s)
{
    s.to_mm = s.to_mm * own_transform(doc, n, s.viewport);
    const std::string_view visibility = doc.property(n, "visibility");
    if (visibility == "visible")
        s.visible = true;
    else if (visibility == "hidden" || visibility == "collapse")
        s.visible = false;
    if (const auto v = doc.number(n, "data-speed-mm-s", 1e-6, max_mm))
        s.speed_mm_s = v;
    if (const auto v = doc.number(n, "data-intensity", 0.0, max_intensity))
        s.intensity = *v;
    if (const auto easing = n.attribute("data-easing"))
        s.easing = read_easing(doc, n, easing.value());
    inherit_svg_look(doc, n, s.viewport, s.look);
    if (const auto v = doc.number(n, "data-carrier-hz", 1.0, highest_carrier_hz))
        s.carrier_hz = v;
}

bool svg_hidden(const svg_document& doc, xml_node n)
{
    return doc.property(n, "display") == "none";
}

void inherit_svg_look(const svg_document& doc, pugi::xml_node n, const svg_viewport& v, svg_look& look)
{
    const std::string_view asked = n.attribute("data-intensity-from").value();
    if (asked == "stroke-width")
        look.asked = svg_strength::stroke_width;
    else if (asked == "opacity")
        look.asked = svg_strength::opacity;
    else if (asked == "none")
        look.asked = svg_strength::none;
    else if (n.attribute("data-intensity-from"))
        doc.fail(n, fmt::format("data-intensity-from of {}: {}", svg_document::called(n), quoted(asked)),
                 "stroke-width, opacity or none");
    if (const auto text = doc.property(n, "stroke-width"); !text.empty() && text != "inherit")
        look.width = read_width(text, v);
    if (const auto text = doc.property(n, "opacity"); !text.empty())
        look.opacity *= read_opacity(text);
    if (const auto text = doc.property(n, "stroke-opacity"); !text.empty() && text != "inherit")
        look.stroke_opacity = read_opacity(text);
}

void check_svg_look(const svg_document& doc, pugi::xml_node n, const svg_look& look)
{
    const auto refuse = [&](std::string_view what, std::string_view hint) {
        doc.fail(n,
                 fmt::format("the {} of {} cannot be read, and data-intensity-from asks for it", what,
                             svg_document::called(n)),
                 hint);
    };
    if (look.asked == svg_strength::stroke_width && std::isnan(look.width))
        refuse("stroke-width", "a length from 0, such as 2 or 0.5mm");
    if (look.asked == svg_strength::opacity && std::isnan(look.shown()))
        refuse("opacity", "a number from 0 to 1 or a percentage");
}

} // namespace tactor::detail
