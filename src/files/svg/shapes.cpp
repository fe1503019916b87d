// SPDX-License-Identifier: MIT
#include "files/svg/document.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/path/impl.hpp"

namespace tactor::detail {
namespace {

constexpr double quarter = std::numbers::pi / 2.0;

struct element {
    const svg_document& doc;
    pugi::xml_node node;
    double per_mm;

    double length(const char* attribute) const { return doc.length(node, attribute, per_mm); }

    double size(const char* attribute) const
    {
        const double v = length(attribute);
        if (v < 0.0)
            doc.leave_out(
                node, fmt::format("{} of {}: {:g} is less than 0", attribute, svg_document::called(node), v),
                "give 0 or more");
        return v;
    }

    // Reads the radii of rect or ellipse. Each may be missing or "auto": then it is the other one.
    std::pair<double, double> radii() const
    {
        const auto has = [this](const char* attribute) {
            const std::string_view text = node.attribute(attribute).value();
            return !text.empty() && text != "auto";
        };
        if (!has("rx") && !has("ry"))
            return {};
        return {size(has("rx") ? "rx" : "ry"), size(has("ry") ? "ry" : "rx")};
    }
};

outline from(point p)
{
    outline o;
    o.vertices.push_back(p);
    return o;
}

std::vector<outline> line(const element& e)
{
    outline o = from({e.length("x1"), e.length("y1")});
    o.line({e.length("x2"), e.length("y2")});
    return {std::move(o)};
}

std::vector<outline> points(const element& e, bool closed)
{
    const auto v = e.doc.read(e.node, "points", [](std::string_view text) {
        std::vector<double> numbers = svg_numbers(text);
        if (numbers.size() % 2 != 0)
            throw value_fault{text.size(), "an x without a y", "give pairs of numbers"};
        return numbers;
    });
    if (!v || v->size() < 4)
        return {};
    outline o = from({(*v)[0], (*v)[1]});
    for (std::size_t i = 2; i < v->size(); i += 2)
        o.line({(*v)[i], (*v)[i + 1]});
    if (closed)
        o.line(o.vertices.front());
    return {std::move(o)};
}

// Draws from three o'clock clockwise, as SVG has it.
std::vector<outline> ellipse(const element& e, double rx, double ry)
{
    if (rx == 0.0 || ry == 0.0)
        return {};
    const point centre{e.length("cx"), e.length("cy")};
    outline o = from({centre.x_mm + rx, centre.y_mm});
    o.arc({centre, {rx, 0.0}, {0.0, ry}, 0.0, 4.0 * quarter}, o.vertices.front());
    return {std::move(o)};
}

// Draws from the left end of the upper side clockwise.
std::vector<outline> rectangle(const element& e)
{
    const double left = e.length("x");
    const double top = e.length("y");
    const double width = e.size("width");
    const double height = e.size("height");
    if (width == 0.0 || height == 0.0)
        return {};
    auto [rx, ry] = e.radii();
    rx = std::min(rx, 0.5 * width);
    ry = std::min(ry, 0.5 * height);
    if (rx == 0.0 || ry == 0.0)
        rx = ry = 0.0;
    const double right = left + width;
    const double bottom = top + height;
    outline o = from({left + rx, top});
    const auto corner = [&, rx = rx, ry = ry](point centre, double angle, point to) {
        if (rx > 0.0)
            o.arc({centre, {rx, 0.0}, {0.0, ry}, angle, quarter}, to);
    };
    o.line({right - rx, top});
    corner({right - rx, top + ry}, -quarter, {right, top + ry});
    o.line({right, bottom - ry});
    corner({right - rx, bottom - ry}, 0.0, {right - rx, bottom});
    o.line({left + rx, bottom});
    corner({left + rx, bottom - ry}, quarter, {left, bottom - ry});
    o.line({left, top + ry});
    corner({left + rx, top + ry}, 2.0 * quarter, {left + rx, top});
    return {std::move(o)};
}

std::vector<outline> path_element(const element& e)
{
    const std::string_view d = e.node.attribute("d").value();
    if (d == "none" || d.find_first_not_of(" \t\r\n\f") == std::string_view::npos)
        return {};
    return *e.doc.read(e.node, "d", [](std::string_view text) {
        return parse_path_data(text, max_user_units, subpaths::any);
    });
}

} // namespace

bool is_svg_shape(std::string_view tag) noexcept
{
    constexpr std::array<std::string_view, 7> tags{"path",   "line",    "polyline", "polygon",
                                                   "circle", "ellipse", "rect"};
    return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

std::vector<outline> svg_shape(const svg_document& doc, pugi::xml_node n, double per_mm)
{
    const element e{doc, n, per_mm};
    const std::string_view tag = svg_tag(n);
    if (tag == "path")
        return path_element(e);
    if (tag == "line")
        return line(e);
    if (tag == "polyline" || tag == "polygon")
        return points(e, tag == "polygon");
    if (tag == "rect")
        return rectangle(e);
    if (tag == "circle") {
        const double r = e.size("r");
        return ellipse(e, r, r);
    }
    const auto [rx, ry] = e.radii();
    return ellipse(e, rx, ry);
}

} // namespace tactor::detail
