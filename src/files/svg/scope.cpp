// SPDX-License-Identifier: MIT
#include "files/svg/scope.hpp"

#include <cmath>
#include <utility>

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
    doc.fail(n, fmt::format("data-easing of {}: {}", svg_document::called(n), detail::quoted(name)),
             "linear, in-out or minimum-jerk");
}

affine moved(double x, double y)
{
    return {1.0, 0.0, 0.0, 1.0, x, y};
}

affine own_transform(const svg_document& doc, xml_node n, const svg_viewport& v,
                     std::optional<point> usual_origin = {})
{
    const auto own = doc.follow(n, "transform", doc.property(n, "transform"),
                                [&v](std::string_view t) { return parse_svg_transform(t, v); });
    if (!own)
        return {};
    if (const std::string_view box = doc.property(n, "transform-box"); !box.empty() && box != "view-box")
        doc.note_unfollowed(n, fmt::format("transform-box: {}", detail::quoted(box)));
    auto origin = doc.follow(n, "transform-origin", doc.property(n, "transform-origin"),
                             [&v](std::string_view t) { return parse_svg_origin(t, v); });
    if (!origin)
        origin = usual_origin;
    return origin ? moved(origin->x_mm, origin->y_mm) * *own * moved(-origin->x_mm, -origin->y_mm) : *own;
}

svg_aspect read_aspect(const svg_document& doc, xml_node n)
{
    constexpr const char* name = "preserveAspectRatio";
    return doc.follow(n, name, n.attribute(name).value(), parse_svg_aspect).value_or(svg_aspect{});
}

bool has(const std::optional<svg_length>& l, svg_length::unit u)
{
    return l && l->in == u;
}

// Returns a side of the drawing: of its style where that says a physical one, else of its attribute.
std::optional<svg_length> read_side(const svg_document& doc, xml_node n, const char* name)
{
    const auto attribute = doc.follow(n, name, n.attribute(name).value(), parse_svg_length);
    const std::string_view said = doc.property(n, name);
    const bool fills = said.empty() || said == "auto" || said.ends_with('%');
    if (fills && !(has(attribute, svg_length::unit::mm) && !said.empty()))
        return attribute;
    const auto styled = doc.follow(n, name, said, [](std::string_view text) {
        const svg_length l = parse_svg_length(text);
        if (l.in != svg_length::unit::mm)
            throw value_fault{0, fmt::format("{} is no length", detail::quoted(text)), ""};
        return l;
    });
    return styled ? styled : attribute;
}

// Returns the transform of the outermost svg in user units, where one of these is a millimetre. As in
// browsers, it is about the middle of the page, and the view box lies in it.
affine flat_transform(const svg_document& doc, xml_node n, const std::optional<svg_view_box>& box,
                      const std::optional<svg_length>& width, const std::optional<svg_length>& height)
{
    using unit = svg_length::unit;
    const bool sized = has(width, unit::none) && has(height, unit::none);
    const bool shaped = sized && width->value > 0.0 && height->value > 0.0;
    const double w = shaped ? width->value : box ? box->width : 0.0;
    const double h = shaped ? height->value : box ? box->height : 0.0;
    const svg_aspect aspect = read_aspect(doc, n);
    const affine in_page = box ? fit(*box, {}, w, h, aspect) : affine{};
    if (box && !aspect.keep && in_page.a != in_page.d)
        doc.note_unfollowed(n, "preserveAspectRatio", ", as its size has no unit");
    if (doc.property(n, "transform").empty())
        return {};
    const affine back{1.0 / in_page.a,       0.0, 0.0, 1.0 / in_page.d, -in_page.e / in_page.a,
                      -in_page.f / in_page.d};
    return back * own_transform(doc, n, {w, h, 1.0}, point{w / 2.0, h / 2.0}) * in_page;
}

// Returns true for an opacity of 0, as a number or a percentage.
bool is_clear(std::string_view text)
{
    try {
        const svg_length l = parse_svg_length(text);
        return l.in != svg_length::unit::mm && l.value <= 0.0;
    } catch (const value_fault&) {
        return false;
    }
}

// Applies the element's own paint.
void inherit_paint(const svg_document& doc, xml_node n, svg_scope& s)
{
    if (const auto text = doc.property(n, "opacity"); !text.empty())
        s.clear = s.clear || is_clear(text);
    for (const auto& [paint, painted] : {std::pair("fill", &s.filled), {"stroke", &s.outlined}})
        if (const auto text = doc.property(n, paint); !text.empty() && text != "inherit")
            *painted = text != "none" && text != "transparent";
}

// Applies the element's own visibility and data-...
void inherit_rest(const svg_document& doc, xml_node n, svg_scope& s)
{
    const std::string_view visibility = doc.property(n, "visibility");
    if (visibility == "visible" || visibility == "initial")
        s.visible = true;
    else if (visibility == "hidden" || visibility == "collapse")
        s.visible = false;
    else if (!visibility.empty() && !is_svg_keyword("visibility", visibility)) {
        s.visible = false;
        doc.note_unknown(n, "visibility", visibility);
    }
    if (const auto v = doc.number(n, "data-speed-mm-s", 1e-6, max_mm))
        s.speed_mm_s = v;
    if (const auto v = doc.number(n, "data-intensity", 0.0, max_intensity))
        s.intensity = *v;
    if (const auto easing = n.attribute("data-easing"))
        s.easing = read_easing(doc, n, easing.value());
    inherit_paint(doc, n, s);
    if (n.attribute("data-intensity-from"))
        doc.note_strength(n);
    if (const auto v = doc.number(n, "data-carrier-hz", 1.0, highest_carrier_hz))
        s.carrier_hz = v;
}

} // namespace

svg_scope svg_root_scope(const svg_document& doc)
{
    const xml_node n = doc.root();
    const auto width = read_side(doc, n, "width");
    const auto height = read_side(doc, n, "height");
    const auto box = doc.read(n, "viewBox", parse_svg_view_box);
    using unit = svg_length::unit;
    svg_scope s;
    if (!has(width, unit::mm) && !has(height, unit::mm)) {
        s.viewport.width = box ? box->width : has(width, unit::none) ? width->value : 100.0;
        s.viewport.height = box ? box->height : has(height, unit::none) ? height->value : 100.0;
        s.to_mm = flat_transform(doc, n, box, width, height);
        inherit_rest(doc, n, s);
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
    s.to_mm = s.to_mm * own_transform(doc, n, s.viewport, point{*w / 2.0, *h / 2.0});
    if (box)
        enter_svg_box(doc, n, s, *box, {}, *w, *h);
    inherit_rest(doc, n, s);
    return s;
}

void enter_svg_box(const svg_document& doc, xml_node n, svg_scope& s, const svg_view_box& box, point corner,
                   double width, double height)
{
    s.to_mm = s.to_mm * fit(box, corner, width, height, read_aspect(doc, n));
    s.viewport.width = box.width;
    s.viewport.height = box.height;
}

void inherit_svg(const svg_document& doc, xml_node n, svg_scope& s)
{
    s.to_mm = s.to_mm * own_transform(doc, n, s.viewport);
    inherit_rest(doc, n, s);
}

bool svg_hidden(const svg_document& doc, xml_node n)
{
    const std::string_view display = doc.property(n, "display");
    const bool known = display.empty() || is_svg_keyword("display", display);
    if (!known)
        doc.note_unknown(n, "display", display);
    return !known || display == "none";
}

} // namespace tactor::detail
