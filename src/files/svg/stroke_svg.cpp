// SPDX-License-Identifier: MIT
// Reads the shapes of an SVG document as strokes.
#include <tactor/stroke.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <unordered_set>
#include <utility>

#include <boost/container_hash/hash.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/kind_names.hpp"
#include "core/path/impl.hpp"
#include "core/suggest.hpp"
#include "core/trajectory/impl.hpp"
#include "files/stroke_format.hpp"
#include "files/svg/document.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::affine;
using detail::omission;
using detail::outline;
using detail::svg_length;
using detail::svg_properties;
using detail::svg_style;
using detail::svg_tag;
using detail::svg_view_box;
using detail::translation;
using pugi::xml_node;

// Greatest depth of nested elements. It is limited because <use> can multiply a small file endlessly.
constexpr unsigned deepest = 100;
constexpr std::size_t most_elements = 1'000'000;
constexpr std::size_t most_vertices = 20'000'000;
constexpr double highest_carrier_hz = 20000.0;

// Properties that an element inherits from its ancestors or has itself.
struct scope {
    affine to_mm;
    std::optional<double> speed_mm_s;
    double intensity = 1.0;
    bool visible = true; ///< visibility, which unlike display a child can override
    std::optional<double> carrier_hz;
    easing_kind easing = easing_kind::linear;
    bool filled = true;
    bool outlined = false;
    bool clear = false; ///< true if this element or an ancestor has opacity 0
    bool fill_clear = false;
    bool stroke_clear = false;
    bool stroke_thin = false; ///< true for a stroke-width of 0
    unsigned depth = 0;       ///< number of ancestors

    bool is_painted() const noexcept
    {
        return ((filled && !fill_clear) || (outlined && !stroke_clear && !stroke_thin)) && !clear;
    }
};

bool is_one(std::string_view word, std::initializer_list<std::string_view> words)
{
    return std::find(words.begin(), words.end(), word) != words.end();
}

// Returns true if a text, such as an opacity, is a number of 0 or less, with or without a unit.
bool is_zero(std::string_view text)
{
    std::size_t at = 0;
    const auto v = detail::scan_number(text, at);
    return v && *v <= 0.0;
}

// Returns true for "none" and for colours whose alpha is 0: #rgb0, #rrggbb00, rgba(r, g, b, 0), rgb(r g b /
// 0).
bool is_clear_paint(std::string_view text)
{
    if (text.starts_with('#'))
        return (text.size() == 5 && text.back() == '0') || (text.size() == 9 && text.ends_with("00"));
    const std::size_t open = text.find('(');
    if (open == text.npos || text.starts_with("url"))
        return text == "none" || text == "transparent";
    const std::size_t slash = text.rfind('/');
    const std::size_t alpha = slash != text.npos                               ? slash
                              : std::count(text.begin(), text.end(), ',') == 3 ? text.rfind(',')
                                                                               : text.npos;
    return alpha != text.npos && is_zero(detail::without_blanks(text.substr(alpha + 1)));
}

bool draws(xml_node n)
{
    const std::string_view tag = svg_tag(n);
    return is_one(tag, {"g", "a", "switch", "use"}) || detail::is_svg_shape(tag);
}

class svg_reader {
public:
    svg_reader(std::string_view text, const std::string& name) : doc_(text, name) {}

    std::vector<stroke> read()
    {
        const xml_node root = doc_.root();
        const svg_style style(root);
        const scope s = root_scope(root, style);
        if (is_hidden(root, style))
            hidden_ = root;
        else
            draw_children(root, s);
        if (!strokes_.empty()) {
            strokes_.front().warnings = doc_.warnings();
            return std::move(strokes_);
        }
        if (omission_)
            throw doc_.to_error(*omission_);
        if (hidden_)
            doc_.fail(hidden_,
                      fmt::format("{} is hidden, and nothing else draws", doc_.element_text(hidden_)),
                      "remove display and visibility");
        throw doc_.to_error(
            {std::nullopt, "it has no shape",
             "use path, line, polyline, polygon, rect, circle or ellipse; convert text to paths"});
    }

private:
    // Returns the scope inside the root element. If the document has a size in physical units, it is drawn at
    // this size. Otherwise one user unit is a millimetre, and coordinates are not changed.
    scope root_scope(xml_node n, const svg_style& style)
    {
        const auto width = read_side(n, style, "width");
        const auto height = read_side(n, style, "height");
        const auto box = doc_.read(n, "viewBox", detail::parse_svg_view_box);
        scope s;
        if ((width && width->in_mm) || (height && height->in_mm)) {
            const auto px = [&](const svg_length& l) {
                if (!(l.value > 0.0))
                    doc_.fail(n, fmt::format("{} has no size", doc_.element_text(n)),
                              "give a width and a height above 0");
                return l.in_mm ? l.value / detail::mm_per_px : l.value;
            };
            const double ratio = box ? box->width / box->height : 1.0;
            const double w = width ? px(*width) : px(*height) * ratio;
            const double h = height ? px(*height) : px(*width) / ratio;
            per_mm_ = 1.0 / detail::mm_per_px;
            s.to_mm = {detail::mm_per_px, 0.0, 0.0, detail::mm_per_px, 0.0, 0.0};
            if (box)
                s.to_mm = s.to_mm * fit_view_box(n, *box, w, h);
        } else if (box && width && height) {
            check_aspect_ratio(n, *box, width->value, height->value);
        }
        inherit(n, style, s);
        return s;
    }

    // Returns the width or height of the drawing. Uses the style if it has a physical unit, otherwise the
    // attribute. Returns nothing for a percentage, which is relative to the window.
    std::optional<svg_length> read_side(xml_node n, const svg_style& style, const char* name) const
    {
        const auto read = [&](std::string_view text) {
            return doc_.parse_or_warn(n, name, text == "auto" || text.ends_with('%') ? "" : text,
                                      detail::parse_svg_length);
        };
        const auto own = read(style.value(name));
        return own && own->in_mm ? own : read(n.attribute(name).value());
    }

    // Returns the map that scales a view box to fit in width x height (user units) and centres it.
    affine fit_view_box(xml_node n, const svg_view_box& box, double width, double height) const
    {
        check_aspect_ratio(n, box, width, height);
        const double k = std::min(width / box.width, height / box.height);
        return {k,
                0.0,
                0.0,
                k,
                -box.corner.x_mm * k + 0.5 * (width - box.width * k),
                -box.corner.y_mm * k + 0.5 * (height - box.height * k)};
    }

    void check_aspect_ratio(xml_node n, const svg_view_box& box, double width, double height) const
    {
        const std::string_view aspect = n.attribute("preserveAspectRatio").value();
        const double spare = width * box.height - height * box.width;
        if (!is_one(aspect, {"", "xMidYMid", "xMidYMid meet"}) && std::abs(spare) > 1e-9 * width * box.height)
            doc_.warn_of_unsupported(n, "preserveAspectRatio");
    }

    void draw_children(xml_node n, const scope& s)
    {
        const bool one = svg_tag(n) == "switch";
        const xml_node chosen = one ? choose(n) : xml_node();
        for (const xml_node c : n.children())
            if (c.type() == pugi::node_element && (!one || c == chosen || !draws(c)))
                visit(c, s);
    }

    // Returns the child of a <switch> that is played. This is the first child without conditions. If each
    // child is for a language, it is the first child.
    xml_node choose(xml_node n) const
    {
        xml_node first;
        for (const xml_node c : n.children()) {
            if (c.type() != pugi::node_element || !draws(c) || c.attribute("requiredExtensions"))
                continue;
            if (!c.attribute("systemLanguage"))
                return c;
            doc_.note(doc_.offset(c), "systemLanguage",
                      fmt::format("systemLanguage of {} is not supported", doc_.element_text(c)),
                      ": a <switch> plays its first shape without one");
            if (!first)
                first = c;
        }
        return first;
    }

    void visit(xml_node n, const scope& s)
    {
        try {
            draw(n, s);
        } catch (const omission& f) {
            warn_of_omission(f);
            if (!omission_)
                omission_ = f;
        }
    }

    void draw(xml_node n, scope s)
    {
        if (++elements_ > most_elements || ++s.depth > deepest)
            doc_.fail(n, elements_ > most_elements ? "too many elements" : "nested too deep",
                      "simplify the drawing, and remove loops of <use>");
        if (!draws(n))
            return warn_of_non_shape(n);
        const std::string_view tag = svg_tag(n);
        const svg_style style(n);
        // Browsers do not show elements that need an extension.
        if (is_hidden(n, style) || n.attribute("requiredExtensions"))
            return note_hidden(n);
        warn_of_unsupported(n, style);
        inherit(n, style, s);
        if (is_one(tag, {"g", "a", "switch"}))
            return draw_children(n, s);
        for (const xml_node c : n.children())
            warn_of_non_shape(c); // an animation, for example
        if (tag == "use")
            draw_use(n, s);
        else if (s.visible)
            draw_shape(n, s);
        else
            note_hidden(n);
    }

    void warn_of_unsupported(xml_node n, const svg_style& style) const
    {
        for (std::size_t i = detail::svg_followed; i < svg_properties.size(); ++i) {
            const std::string_view p = svg_properties[i];
            const std::string_view v = style.value(p);
            const bool idle = p.starts_with("transform-") && style.value("transform").empty();
            if (!v.empty() && v != "none" && !idle)
                doc_.warn_of_unsupported(n, p);
        }
    }

    void warn_of_omission(const omission& f) const
    {
        doc_.note(f.offset, f.hint, fmt::format("{} ({}): left out", f.why, f.hint), "");
    }

    // Adds a warning about an element that is not a shape but that browsers draw. Elements of other programs,
    // which have a prefix, get no warning.
    void warn_of_non_shape(xml_node n) const
    {
        const std::string_view tag = svg_tag(n);
        const bool silent =
            is_one(tag, {"defs", "symbol", "clipPath", "mask", "marker", "pattern", "filter",
                         "linearGradient", "radialGradient", "style", "script", "title", "desc", "metadata"});
        if (n.type() == pugi::node_element && tag.find(':') == std::string_view::npos && !silent &&
            (tag == "svg" || svg_tag(n.parent()) != "switch") && !is_hidden(n, svg_style(n)))
            doc_.note(doc_.offset(n), tag, fmt::format("{} does not play", doc_.element_text(n)),
                      ": only shapes do, and text converted to paths");
    }

    // Keeps the first hidden element. If nothing is drawn, the message names it.
    void note_hidden(xml_node n)
    {
        if (!hidden_)
            hidden_ = n;
    }

    bool is_hidden(xml_node n, const svg_style& style) const
    {
        const std::string_view display = style.value("display");
        if (!is_one(display,
                    {"", "none", "inline", "block", "inline-block", "flex", "grid", "inherit", "initial"}))
            doc_.warn_of_unsupported(n, "display", fmt::format(" ({})", detail::quoted(display)));
        return display == "none" || (display.empty() && doc_.hides(n));
    }

    // Applies the element's own transform, visibility, paint and data-... attributes to the scope.
    void inherit(xml_node n, const svg_style& style, scope& s) const
    {
        const std::string_view transform = style.value("transform");
        if (n == doc_.root() && !transform.empty()) // browsers apply it about the centre of the page
            doc_.warn_of_unsupported(n, "transform");
        else if (const auto own = doc_.parse_or_warn(n, "transform", transform, detail::parse_svg_transform))
            s.to_mm = s.to_mm * *own;
        const std::string_view visibility = style.value("visibility");
        if (is_one(visibility, {"visible", "initial", "hidden", "collapse"}))
            s.visible = is_one(visibility, {"visible", "initial"});
        else if (!is_one(visibility, {"", "inherit"}))
            doc_.warn_of_unsupported(n, "visibility", fmt::format(" ({})", detail::quoted(visibility)));
        s.clear = s.clear || is_zero(style.value("opacity"));
        const auto set = [&style](const char* property, bool& to, bool (*is)(std::string_view)) {
            if (const auto text = style.value(property); !is_one(text, {"", "inherit"}))
                to = is(text);
        };
        const auto paints = [](std::string_view text) { return !is_clear_paint(text); };
        set("fill", s.filled, paints);
        set("stroke", s.outlined, paints);
        set("fill-opacity", s.fill_clear, is_zero);
        set("stroke-opacity", s.stroke_clear, is_zero);
        set("stroke-width", s.stroke_thin, is_zero);
        if (const auto v = doc_.number(n, "data-speed-mm-s", 1e-6, detail::max_mm))
            s.speed_mm_s = v;
        if (const auto v = doc_.number(n, "data-intensity", 0.0, detail::max_intensity))
            s.intensity = *v;
        if (const auto v = doc_.number(n, "data-carrier-hz", 1.0, highest_carrier_hz))
            s.carrier_hz = v;
        if (const auto name = n.attribute("data-easing")) {
            const auto k = detail::find_kind<easing_kind>(name.value());
            if (!k)
                doc_.fail(
                    n,
                    fmt::format("data-easing of {}: {}", doc_.element_text(n), detail::quoted(name.value())),
                    "linear, in-out or minimum-jerk");
            s.easing = *k;
        }
    }

    void draw_use(xml_node n, scope s)
    {
        std::string_view href = n.attribute("href").value();
        if (href.empty())
            href = n.attribute("xlink:href").value();
        if (href.size() < 2 || href.front() != '#')
            doc_.leave_out(n, fmt::format("{} refers to nothing in this file", doc_.element_text(n)),
                           "use href=\"#id\"");
        const xml_node target = doc_.by_id(href.substr(1));
        if (!target)
            doc_.leave_out(
                n, fmt::format("{} refers to {}, which is not in this file", doc_.element_text(n), href),
                "correct the id");
        if (!draws(target))
            doc_.leave_out(n,
                           fmt::format("{} refers to {}, which does not play", doc_.element_text(n),
                                       doc_.element_text(target)),
                           "refer to a shape or a group");
        s.to_mm = s.to_mm * translation({doc_.length(n, "x", per_mm_), doc_.length(n, "y", per_mm_)});
        visit(target, s);
    }

    void draw_shape(xml_node n, const scope& s)
    {
        std::vector<outline> outlines = svg_shape(doc_, n, per_mm_);
        if (outlines.empty())
            doc_.leave_out(n, fmt::format("{} draws nothing", doc_.element_text(n)),
                           "give it a size, or path data that draws");
        const double scale = std::hypot(s.to_mm.a, s.to_mm.b) * std::hypot(s.to_mm.c, s.to_mm.d);
        if (!(std::abs(s.to_mm.determinant()) > 1e-9 * scale))
            doc_.leave_out(n, fmt::format("{} is flattened by its transform", doc_.element_text(n)),
                           "avoid a scale of 0 and a skew of 90 degrees");
        std::vector<path> paths;
        std::size_t look = 0; // hash, equal for equal shapes in equal places
        for (outline& o : outlines) {
            vertices_ += o.vertices.size();
            if (vertices_ > most_vertices)
                doc_.fail(n, "too many points", "simplify the drawing");
            outline placed = apply_map(std::move(o), s.to_mm);
            // Finds the line and column only if there is an error, because this takes a scan of the file up
            // to the element.
            const std::string what = find_bad_coordinate(placed)
                                         ? fmt::format("{}: {}", doc_.where(n).text(), doc_.element_text(n))
                                         : "";
            for (const point p : placed.vertices) {
                boost::hash_combine(look, p.x_mm);
                boost::hash_combine(look, p.y_mm);
            }
            paths.push_back(detail::make_path(std::move(placed), what));
            boost::hash_combine(look, paths.back().length_mm());
        }
        remove_point_subpaths(n, paths);
        if (!looks_.insert(look).second && !n.attribute("data-start-s"))
            doc_.note(doc_.offset(n), "twice",
                      fmt::format("{} has the same shape as an earlier element", doc_.element_text(n)),
                      ": it plays again");
        if (!s.is_painted() && !doc_.has_rules())
            doc_.note(doc_.offset(n), "unpainted",
                      fmt::format("{} has neither fill nor stroke, or no opacity", doc_.element_text(n)),
                      ": it still plays");
        add(n, s, paths);
    }

    // Removes subpaths that are points. If all subpaths are points and there is a duration, keeps them as
    // taps.
    void remove_point_subpaths(xml_node n, std::vector<path>& paths)
    {
        const auto is_point = [](const path& p) { return p.length_mm() == 0.0; };
        const bool all = std::all_of(paths.begin(), paths.end(), is_point);
        if (all && !n.attribute("data-duration-s"))
            doc_.leave_out(n, fmt::format("{}: it has no length", doc_.element_text(n)),
                           "add data-duration-s to make it a tap");
        if (!all && std::erase_if(paths, is_point) != 0)
            warn_of_omission({doc_.offset(n),
                              fmt::format("{}: a subpath has no length", doc_.element_text(n)),
                              "it draws a point"});
    }

    // Adds a shape as strokes. The subpaths share the shape's duration in proportion to their lengths.
    void add(xml_node n, const scope& s, const std::vector<path>& paths)
    {
        const auto duration = doc_.number(n, "data-duration-s", 1e-6, detail::longest_stroke_s);
        auto start = doc_.number(n, "data-start-s", 0.0, detail::longest_stroke_s);
        if (duration && n.attribute("data-speed-mm-s"))
            doc_.fail(n, fmt::format("{} has both data-duration-s and data-speed-mm-s", doc_.element_text(n)),
                      "keep one of them");
        double all = 0.0;
        for (const path& p : paths)
            all += p.length_mm();
        const std::string_view id = n.attribute("id").value();
        const std::string name(id.empty() ? svg_tag(n) : id);
        for (std::size_t i = 0; i < paths.size(); ++i) {
            const double length = paths[i].length_mm();
            const double speed = s.speed_mm_s.value_or(default_speed_mm_s);
            const double part = all > 0.0 ? length / all : 1.0 / static_cast<double>(paths.size());
            const double time = duration ? *duration * part : length / speed;
            if (time > detail::longest_stroke_s)
                doc_.fail(n, fmt::format("{} lasts {:g} s", doc_.element_text(n), time), "use at most a day");
            strokes_.push_back(
                {.name = paths.size() == 1 ? name : fmt::format("{}-{}", name, i + 1),
                 .motion = trajectory::along(paths[i], {.duration_s = time, .easing = s.easing}, s.intensity),
                 .start_s = start,
                 .speed_mm_s = duration ? std::nullopt : std::optional(speed),
                 .usual_pace = !duration && !s.speed_mm_s,
                 .sound = {.carrier_hz = s.carrier_hz}});
            start.reset();
        }
    }

    detail::svg_document doc_;
    std::vector<stroke> strokes_;
    std::optional<omission> omission_; ///< first omission
    std::unordered_set<std::size_t> looks_;
    xml_node hidden_;
    double per_mm_ = 1.0; ///< user units per mm
    std::size_t elements_ = 0;
    std::size_t vertices_ = 0;
};

} // namespace

} // namespace v0
} // namespace tactor

namespace tactor::detail {
namespace {

using pugi::xml_node;

// Adds a path that is played as a stroke. Timed points become straight lines at a constant speed.
void add_stroke(xml_node svg, const stroke& s)
{
    const trajectory::impl& i = access::of(s.motion);
    const auto* const drawn = std::get_if<drawn_path>(&i.law);
    xml_node p = svg.append_child("path");
    const auto set = [&p](const char* name, const auto& value) {
        p.append_attribute(name).set_value(fmt::format("{}", value).c_str());
    };
    const auto set_path = [&set](const path& way) {
        set("d", way.svg() + (way.length_mm() > 0.0 ? "" : " h 0")); // a path that only moves draws nothing
    };
    if (!s.name.empty())
        set("id", s.name);
    double strength = i.gain;
    if (drawn != nullptr) {
        set_path(drawn->way);
        strength *= drawn->intensity;
        if (drawn->moves && drawn->moves->definition().easing != easing_kind::linear)
            set("data-easing", to_string(drawn->moves->definition().easing));
    } else {
        std::vector<point> places;
        for (const timed_point& t : *std::get<timed_points>(i.law).points)
            places.push_back(t.position);
        set_path(path::polyline(places));
    }
    set("data-duration-s", i.duration_s);
    if (s.start_s)
        set("data-start-s", *s.start_s);
    if (strength != 1.0)
        set("data-intensity", strength);
    if (s.sound.carrier_profile.empty() && s.sound.carrier_hz.value_or(HUGE_VAL) <= highest_carrier_hz)
        set("data-carrier-hz", *s.sound.carrier_hz);
}

// Writes a document in which one user unit is a millimetre, with a margin around the strokes.
std::string format_svg(std::span<const stroke> all)
{
    constexpr double margin_mm = 2.0;
    constexpr int steps = 256;
    std::vector<point> places;
    pugi::xml_document document;
    xml_node svg = document.append_child("svg");
    for (const stroke& s : all) {
        add_stroke(svg, s);
        for (int k = 0; k <= steps; ++k)
            places.push_back(s.motion.position(s.motion.duration_s() * k / steps));
    }
    const box b = bounding_box(places);
    const point size = b.high - b.low + point{2.0 * margin_mm, 2.0 * margin_mm};
    for (const auto& [name, value] : {std::pair("xmlns", std::string("http://www.w3.org/2000/svg")),
                                      {"viewBox", fmt::format("{} {} {} {}", b.low.x_mm - margin_mm,
                                                              b.low.y_mm - margin_mm, size.x_mm, size.y_mm)},
                                      {"fill", "none"},
                                      {"stroke", "black"}})
        svg.append_attribute(name).set_value(value.c_str());
    std::ostringstream text;
    document.save(text, " ");
    return std::move(text).str();
}

constexpr std::string_view svg_extensions[] = {".svg"};

} // namespace

extern const stroke_format svg_strokes{
    .name = "svg",
    .title = "SVG",
    .extensions = svg_extensions,
    .media_type = "image/svg+xml",
    .begins = [](std::string_view text) { return find_text_form(text) == text_form::xml; },
    .parse = [](const stroke_file_text& s) { return svg_reader(s.text, s.name).read(); },
    .write = format_svg,
    .comment = {"<?", "?>"},
    .shorten = "simplify the drawing",
};

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<stroke> parse_strokes_svg(std::string_view text, const std::string& name)
{
    return detail::read_stroke_text(detail::svg_strokes, {text, name});
}

} // namespace v0
} // namespace tactor
