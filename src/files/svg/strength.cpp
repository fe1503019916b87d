// SPDX-License-Identifier: MIT
#include "files/svg/strength.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/suggest.hpp"

namespace tactor::detail {
namespace {

constexpr double no_look = std::numeric_limits<double>::quiet_NaN();

// A number from 0 to 1, or a percentage of it; beyond counts as the bound, as CSS has it.
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
