// SPDX-License-Identifier: MIT
#include "files/svg/document.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>

#include "core/path/impl.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

/// Largest number that is plausible in any unit.
constexpr double max_user_units = 1e9;

std::string tidy(std::string_view text)
{
    return to_lower_case(std::string(without_blanks(text)));
}

// Calls f(index, value) for each property of svg_properties that a style or a rule sets.
template <class F>
void for_each_declaration(std::string_view css, F f)
{
    for (std::size_t at = 0; at < css.size();) {
        const std::size_t end = std::min(css.find_first_of(";{}", at), css.size());
        const std::string_view item = without_blanks(css.substr(at, end - at));
        const std::size_t colon = item.find(':');
        const auto* known =
            std::find(svg_properties.begin(), svg_properties.end(), tidy(item.substr(0, colon)));
        if (item.starts_with('&'))
            f(svg_display, item); // an XML entity: its text may hide the element
        else if (known != svg_properties.end() && colon != std::string_view::npos)
            f(static_cast<std::size_t>(known - svg_properties.begin()), item.substr(colon + 1));
        at = end + 1;
    }
}

double read_svg_number(std::string_view text, std::size_t& at)
{
    const std::size_t begin = at;
    const auto v = scan_number(text, at);
    if (!v)
        throw value_fault{at, fmt::format("{} is not a number", detail::quoted(text.substr(at))),
                          "e.g. 12.5"};
    if (!(std::abs(*v) <= max_user_units))
        throw value_fault{begin, fmt::format("{:g} is beyond {:g}", *v, max_user_units), "check the unit"};
    return *v;
}

double parse_svg_number(std::string_view text)
{
    std::size_t at = 0;
    skip_blanks(text, at);
    const double v = read_svg_number(text, at);
    if (const auto rest = without_blanks(text.substr(at)); !rest.empty())
        throw value_fault{at, fmt::format("{} follows the number", detail::quoted(rest)),
                          "give a number without a unit"};
    return v;
}

// Reads numbers that are separated by blanks or commas. Skips `unit` after each number.
std::vector<double> parse_svg_numbers(std::string_view text, std::string_view unit = {})
{
    std::vector<double> all;
    std::size_t at = 0;
    skip_blanks(text, at);
    while (at < text.size()) {
        all.push_back(read_svg_number(text, at));
        at += text.substr(at).starts_with(unit) ? unit.size() : 0;
        skip_blanks(text, at);
        if (at < text.size() && text[at] == ',') {
            ++at;
            skip_blanks(text, at);
            if (at == text.size())
                throw value_fault{at, "it ends with a comma", "write a number after the comma"};
        }
    }
    return all;
}

double tangent(double degrees)
{
    return std::tan(degrees * std::numbers::pi / 180.0);
}

affine make_transform(std::string_view name, const std::vector<double>& v)
{
    const std::size_t n = v.size();
    if (name == "matrix" && n == 6)
        return {v[0], v[1], v[2], v[3], v[4], v[5]};
    if (name == "translate" && (n == 1 || n == 2))
        return translation({v[0], n == 2 ? v[1] : 0.0});
    if (name == "scale" && (n == 1 || n == 2))
        return {v[0], 0.0, 0.0, v[n - 1], 0.0, 0.0};
    if (name == "rotate" && n == 1)
        return rotation(v[0]);
    if (name == "rotate" && n == 3)
        return translation({v[1], v[2]}) * rotation(v[0]) * translation({-v[1], -v[2]});
    if (name == "skewx" && n == 1)
        return {1.0, 0.0, tangent(v[0]), 1.0, 0.0, 0.0};
    if (name == "skewy" && n == 1)
        return {1.0, tangent(v[0]), 0.0, 1.0, 0.0, 0.0};
    throw value_fault{
        0, fmt::format("{} with {} is not a transform", detail::quoted(name), counted(n, "number")), ""};
}

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
                node,
                fmt::format("{} of {}: {:g} is less than 0", attribute, svg_document::element_text(node), v),
                "give 0 or more");
        return v;
    }

    // Reads the two radii of a rect or an ellipse. A radius that is missing or "auto" is equal to the other
    // one.
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
        std::vector<double> numbers = parse_svg_numbers(text);
        if (numbers.size() % 2 != 0)
            throw value_fault{text.size(), "an x has no y", "give pairs of numbers"};
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

// Draws an ellipse clockwise from three o'clock, as SVG does.
std::vector<outline> ellipse(const element& e, double rx, double ry)
{
    if (rx == 0.0 || ry == 0.0)
        return {};
    const point centre{e.length("cx"), e.length("cy")};
    outline o = from({centre.x_mm + rx, centre.y_mm});
    o.arc({centre, {rx, 0.0}, {0.0, ry}, 0.0, 4.0 * quarter}, o.vertices.front());
    return {std::move(o)};
}

// Draws a rectangle clockwise from the left end of its upper side, which is next to a rounded corner if any.
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
    if (d == "none" || without_blanks(d).empty())
        return {};
    return *e.doc.read(e.node, "d", [](std::string_view text) {
        return parse_path_data(text, max_user_units, subpaths::any);
    });
}

} // namespace

svg_length parse_svg_length(std::string_view text)
{
    constexpr std::pair<std::string_view, double> units[] = {
        {"mm", 1.0},        {"cm", 10.0},      {"in", 25.4}, {"pt", 25.4 / 72.0},
        {"pc", 25.4 / 6.0}, {"px", mm_per_px}, {"q", 0.25}};
    std::size_t at = 0;
    skip_blanks(text, at);
    const double v = read_svg_number(text, at);
    const std::string unit = tidy(text.substr(at));
    if (unit.empty())
        return {v};
    for (const auto& [name, mm] : units)
        if (name == unit)
            return {v * mm, true};
    throw value_fault{at, fmt::format("unit {} is unknown", detail::quoted(unit)),
                      "use mm, cm, in, pt, pc, px, Q"};
}

svg_view_box parse_svg_view_box(std::string_view text)
{
    const std::vector<double> v = parse_svg_numbers(text);
    if (v.size() != 4)
        throw value_fault{0, fmt::format("it has {} of 4 numbers", v.size()), "give x, y, width and height"};
    if (!(v[2] > 0.0 && v[3] > 0.0))
        throw value_fault{0, "it has no size", "give a width and a height above 0"};
    return {{v[0], v[1]}, v[2], v[3]};
}

affine parse_svg_transform(std::string_view text)
{
    affine all;
    if (text == "none")
        return all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t open = text.find('(', at);
        const std::size_t close = text.find(')', at);
        if (close == std::string_view::npos || !(open < close))
            throw value_fault{0, fmt::format("{} is not a transform", detail::quoted(text.substr(at))), ""};
        const std::string_view name = without_blanks(text.substr(at, open - at));
        const bool turns = name == "rotate" || name.starts_with("skew");
        const std::string_view unit = turns ? "deg" : name == "translate" ? "px" : "";
        all = all * make_transform(name, parse_svg_numbers(text.substr(open + 1, close - open - 1), unit));
        at = close + 1;
        while (at < text.size() && (blank(text[at]) || text[at] == ','))
            ++at;
    }
    return all;
}

svg_style::svg_style(pugi::xml_node n)
{
    const auto take = [this](std::size_t property, std::string_view text) {
        if (std::string value = tidy(text.substr(0, text.find('!'))); !value.empty())
            values_[svg_properties[property]] = std::move(value);
    };
    for (std::size_t i = 0; i < svg_attributes; ++i)
        take(i, n.attribute(svg_properties[i].data()).value());
    for_each_declaration(n.attribute("style").value(), take);
}

std::string_view svg_style::value(std::string_view property) const
{
    const auto found = values_.find(property);
    return found == values_.end() ? std::string_view() : found->second;
}

svg_document::svg_document(std::string_view text, const std::string& name)
    : text_(strip_byte_order_mark(text)), name_(name), buffer_(text_)
{
    const pugi::xml_parse_result r =
        tree_.load_buffer_inplace(buffer_.data(), buffer_.size(), pugi::parse_default | pugi::parse_pi);
    if (r.status == pugi::status_out_of_memory)
        throw std::bad_alloc();
    if (!r) {
        refuse_other_form(text_, name_, text_form::xml);
        throw error(error_kind::bad_input,
                    place(static_cast<std::size_t>(std::max<std::ptrdiff_t>(r.offset, 0))), r.description(),
                    "correct the file: it is not well-formed XML");
    }
    if (svg_tag(root()) != "svg")
        fail(root(), fmt::format("{} is not <svg>", element_text(root())), "name an SVG file");
    for (const pugi::xml_node n : tree_.children("xml-stylesheet"))
        warn_of_other_file(n, "<?xml-stylesheet?>");
    // find_node() visits all nodes, without recursion, if its function always returns false. If two elements
    // have the same id, the first one counts.
    tree_.find_node([this](pugi::xml_node n) {
        if (const std::string_view id = n.attribute("id").value(); !id.empty())
            ids_.try_emplace(id, n);
        if (svg_tag(n) == "style")
            read_style_rules(n);
        return false;
    });
}

std::string_view svg_tag(pugi::xml_node n)
{
    std::string_view tag = n.name();
    if (tag.substr(0, 4) == "svg:")
        tag.remove_prefix(4);
    return tag;
}

pugi::xml_node svg_document::by_id(std::string_view id) const
{
    const auto found = ids_.find(id);
    return found == ids_.end() ? pugi::xml_node() : found->second;
}

source_place svg_document::place(std::optional<std::size_t> offset) const
{
    return offset ? find_place(text_, *offset, name_) : source_place{name_};
}

std::optional<std::size_t> svg_document::offset(pugi::xml_node n) const
{
    const auto at = n.offset_debug();
    return at < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(at));
}

std::string svg_document::element_text(pugi::xml_node n)
{
    const std::string_view id = n.attribute("id").value();
    const std::string tag = detail::quoted(n.name());
    return fmt::format("<{}>{}", std::string_view(tag).substr(1, tag.size() - 2),
                       id.empty() ? std::string() : fmt::format(" {}", detail::quoted(id)));
}

error svg_document::to_error(const omission& f) const
{
    return {error_kind::bad_input, place(f.offset), f.why, f.hint};
}

void svg_document::fail(pugi::xml_node n, std::string_view why, std::string_view hint) const
{
    throw error(error_kind::bad_input, where(n), why, hint);
}

void svg_document::leave_out(pugi::xml_node n, std::string why, std::string hint) const
{
    throw omission{offset(n), std::move(why), std::move(hint)};
}

omission svg_document::fault(pugi::xml_node n, pugi::xml_attribute a, const value_fault& f) const
{
    // The parser decodes values in place, so a value begins at its offset in the text. If the encoding is not
    // UTF-8, the text is converted in another buffer.
    const char* value = a.value();
    const bool here =
        std::less_equal<>{}(buffer_.data(), value) && std::less<>{}(value, buffer_.data() + buffer_.size());
    return {here ? static_cast<std::size_t>(value - buffer_.data()) + f.offset : offset(n),
            fmt::format("{} of {}: {}", a.name(), element_text(n), f.why), f.hint};
}

double svg_document::length(pugi::xml_node n, const char* attribute, double per_mm) const
{
    const pugi::xml_attribute a = n.attribute(attribute);
    try {
        const svg_length l = a ? parse_svg_length(a.value()) : svg_length{};
        return l.in_mm ? l.value * per_mm : l.value;
    } catch (const value_fault& f) {
        throw fault(n, a, f);
    }
}

std::optional<double> svg_document::number(pugi::xml_node n, const char* attribute, double low,
                                           double high) const
{
    return read(n, attribute, [low, high](std::string_view text) {
        const double v = parse_svg_number(text);
        if (!(v >= low && v <= high))
            throw value_fault{0, fmt::format("{:g}", v), fmt::format("give {:g} to {:g}", low, high)};
        return v;
    });
}

void svg_document::note(std::optional<std::size_t> offset, std::string_view key, std::string text,
                        const char* end) const
{
    const auto [at, first] = notes_.try_emplace(std::string(key));
    if (first)
        at->second = {offset, std::move(text), end};
    ++at->second.elements;
}

void svg_document::warn_of_unsupported(pugi::xml_node n, std::string_view what, std::string_view why) const
{
    note(offset(n), what, fmt::format("{} of {} is not supported{}", what, element_text(n), why),
         ": a shape that it hides or moves plays as if it were not there");
}

void svg_document::warn_of_other_file(pugi::xml_node n, std::string_view what) const
{
    note(offset(n), "stylesheet", fmt::format("{} names another file, which is not read", what),
         ": a shape that its rules hide or move plays as if they were not there (put the rules into the "
         "drawing)");
}

// Reads the rules of <style>. Most rules affect only painting, which does not decide what is played. But
// Illustrator hides layers with class selectors, so rules for classes that hide are supported. Refuses other
// selectors that hide elements, because this code cannot find these elements.
void svg_document::read_style_rules(pugi::xml_node style)
{
    has_rules_ = true;
    for (const pugi::xml_node c : style.children()) {
        std::string_view css = c.value();
        if (to_lower_case(std::string(css)).find("@import") != css.npos)
            warn_of_other_file(style, "@import");
        for (std::size_t open = css.find('{'); open != css.npos; open = css.find('{')) {
            const std::string_view before = css.substr(0, open);
            const std::string_view selectors = before.substr(before.rfind(';') + 1);
            const std::size_t close = std::min(css.find('}', open), css.size() - 1);
            for_each_declaration(css.substr(open + 1, close - open), [&](std::size_t property,
                                                                         std::string_view v) {
                const std::string value = tidy(v.substr(0, v.find('!')));
                if ((property == svg_display && value == "none") ||
                    (property == svg_visibility && (value == "hidden" || value == "collapse"))) {
                    if (!add_hidden_classes(selectors))
                        fail(style,
                             fmt::format("a rule hides the elements of {}, a selector that is not supported",
                                         quoted(without_blanks(selectors))),
                             "delete the hidden elements, or export presentation attributes");
                    return;
                }
                if (property < svg_paints || notes_.contains("style"))
                    return;
                note(offset(style), "style",
                     fmt::format("{} in {} is not supported", svg_properties[property], element_text(style)),
                     ": a shape that it hides or moves plays as if it were not there (export presentation "
                     "attributes)");
            });
            css.remove_prefix(close + 1);
        }
    }
}

bool svg_document::add_hidden_classes(std::string_view selectors)
{
    std::vector<std::string_view> names = split(selectors, ',');
    for (std::string_view& name : names) {
        name = without_blanks(name);
        if (name.size() < 2 || name.front() != '.' || name.find_first_of(" \t\n.#:>[*+~", 1) != name.npos)
            return false;
        name.remove_prefix(1);
    }
    hidden_.insert(names.begin(), names.end());
    return true;
}

bool svg_document::hides(pugi::xml_node n) const
{
    const std::vector<std::string_view> classes = split(n.attribute("class").value(), ' ');
    return std::any_of(classes.begin(), classes.end(),
                       [this](std::string_view c) { return hidden_.contains(c); });
}

std::vector<std::string> svg_document::warnings() const
{
    std::vector<std::string> all;
    for (const auto& [key, n] : notes_)
        all.push_back(fmt::format(
            "{}: {}{}{}", place(n.offset).text(), n.text,
            n.elements == 1 ? "" : fmt::format(" (and {} more)", counted(n.elements - 1, "element")), n.end));
    return all;
}

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
