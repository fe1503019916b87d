// SPDX-License-Identifier: MIT
// The shapes of an SVG document as strokes.
#include <tactor/stroke.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_set>
#include <utility>

#include <boost/container_hash/hash.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/limits.hpp"
#include "core/path/impl.hpp"
#include "files/svg/document.hpp"
#include "files/svg/scope.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::affine;
using detail::enter_svg_box;
using detail::inherit_svg;
using detail::left_out;
using detail::outline;
using detail::svg_extent;
using detail::svg_hidden;
using detail::svg_tag;
using scope = detail::svg_scope;
using pugi::xml_node;

// <use> can multiply a small file without end.
constexpr unsigned deepest = 100;
constexpr unsigned most_uses_inside = 16;
constexpr std::size_t most_elements = 1'000'000;
constexpr std::size_t most_vertices = 20'000'000;

class svg_reader {
public:
    svg_reader(std::string_view text, const std::string& name) : doc_(text, name) {}

    std::vector<stroke> read()
    {
        const xml_node root = doc_.root();
        const scope s = detail::svg_root_scope(doc_);
        note_unfollowed(root);
        if (svg_hidden(doc_, root))
            hidden_ = root;
        else
            children(root, s);
        if (!strokes_.empty()) {
            strokes_.front().warnings = doc_.warnings();
            return std::move(strokes_);
        }
        if (left_out_)
            throw doc_.to_error(*left_out_);
        if (hidden_)
            doc_.fail(hidden_, fmt::format("{} is hidden, and nothing else draws", doc_.called(hidden_)),
                      "take out display or visibility");
        throw error(
            error_kind::bad_input, source_place{doc_.name()}, "no shape in it",
            "strokes are path, line, polyline, polygon, rect, circle and ellipse; make paths of text");
    }

private:
    void children(xml_node n, const scope& s)
    {
        for (const xml_node c : n.children())
            if (c.type() == pugi::node_element)
                visit(c, s);
    }

    void visit(xml_node n, const scope& s)
    {
        try {
            draw(n, s);
        } catch (const left_out& f) {
            doc_.note_left_out(f);
            if (!left_out_)
                left_out_ = f;
        }
    }

    void draw(xml_node n, scope s)
    {
        if (++elements_ > most_elements || ++s.depth > deepest)
            doc_.fail(n, elements_ > most_elements ? "too many elements" : "nested too deep",
                      "simplify the drawing");
        const std::string_view tag = svg_tag(n);
        const bool group = tag == "g" || tag == "a" || tag == "switch";
        if (!draws(n))
            return note_no_shape(n);
        if (svg_hidden(doc_, n))
            return note_hidden(n);
        note_unfollowed(n);
        inherit_svg(doc_, n, s);
        if (!group && tag != "svg")
            for (const xml_node c : n.children())
                note_no_shape(c); // an animation
        if (group)
            children(n, s);
        else if (tag == "svg")
            frame(n, n, s,
                  {doc_.length(n, "x", s.viewport, svg_extent::width),
                   doc_.length(n, "y", s.viewport, svg_extent::height)});
        else if (tag == "use")
            use(n, s);
        else if (s.visible)
            shape(n, s);
        else
            note_hidden(n);
    }

    // Notes features that are not followed. SVG viewers draw one child of a switch.
    void note_unfollowed(xml_node n) const
    {
        const bool root = n == doc_.root(); // whose width and height are followed
        for (const std::string_view what : detail::unfollowed_svg_properties)
            if (const std::string_view v = doc_.property(n, what);
                !v.empty() && v != "none" && !(root && (what == "width" || what == "height")))
                doc_.note_unfollowed(n, std::string(what));
        if (svg_tag(n) == "switch" && std::count_if(n.begin(), n.end(), draws) > 1)
            doc_.note_unfollowed(n, "the choice");
    }

    // Notes an element that draws in browsers although it is no shape. Those of other programs have a prefix.
    void note_no_shape(xml_node n) const
    {
        constexpr std::array<std::string_view, 20> silent{
            "defs",    "symbol", "clipPath",       "mask",           "marker",
            "pattern", "filter", "linearGradient", "radialGradient", "style",
            "script",  "title",  "desc",           "metadata",       "view",
            "cursor",  "font",   "font-face",      "color-profile",  "solidColor"};
        const std::string_view tag = svg_tag(n);
        if (n.type() == pugi::node_element && tag.find(':') == std::string_view::npos &&
            std::find(silent.begin(), silent.end(), tag) == silent.end() && svg_tag(n.parent()) != "switch" &&
            !svg_hidden(doc_, n))
            doc_.note_no_shape(n);
    }

    static bool draws(xml_node n)
    {
        const std::string_view tag = svg_tag(n);
        return tag == "g" || tag == "a" || tag == "switch" || tag == "svg" || tag == "use" ||
               detail::is_svg_shape(tag);
    }

    // Keeps the first hidden element, to name it if nothing draws.
    void note_hidden(xml_node n)
    {
        if (!hidden_)
            hidden_ = n;
    }

    // Draws a nested svg, or a symbol that `sized` uses.
    void frame(xml_node n, xml_node sized, scope s, point corner)
    {
        const auto side = [&](const char* attribute, svg_extent e, double whole) {
            const xml_node from = sized.attribute(attribute) ? sized : n;
            const double v = doc_.length(from, attribute, s.viewport, e, whole);
            if (!(v > 0.0))
                doc_.leave_out(from, fmt::format("{} has no size", doc_.called(from)),
                               "width and height are more than 0");
            return v;
        };
        const double width = side("width", svg_extent::width, s.viewport.width);
        const double height = side("height", svg_extent::height, s.viewport.height);
        if (const auto box = doc_.read(n, "viewBox", detail::parse_svg_view_box)) {
            enter_svg_box(doc_, n, s, *box, corner, width, height);
        } else {
            s.to_mm = s.to_mm * affine{1.0, 0.0, 0.0, 1.0, corner.x_mm, corner.y_mm};
            s.viewport.width = width;
            s.viewport.height = height;
        }
        children(n, s);
    }

    void use(xml_node n, scope s)
    {
        std::string_view href = n.attribute("href").value();
        if (href.empty())
            href = n.attribute("xlink:href").value();
        if (href.size() < 2 || href.front() != '#')
            doc_.leave_out(n, fmt::format("{} refers to nothing in this file", doc_.called(n)),
                           "href=\"#id\"");
        const xml_node target = doc_.by_id(href.substr(1));
        if (!target)
            doc_.leave_out(n, fmt::format("{} refers to {}, which is not in this file", doc_.called(n), href),
                           "correct the id");
        if (++s.uses > most_uses_inside)
            doc_.fail(n, fmt::format("{} refers to itself, or too deep", doc_.called(n)),
                      "take the loop out");
        const point corner{doc_.length(n, "x", s.viewport, svg_extent::width),
                           doc_.length(n, "y", s.viewport, svg_extent::height)};
        s.to_mm = s.to_mm * affine{1.0, 0.0, 0.0, 1.0, corner.x_mm, corner.y_mm};
        const std::string_view tag = svg_tag(target);
        if (tag != "symbol" && tag != "svg")
            return visit(target, s);
        ++s.depth;
        inherit_svg(doc_, target, s);
        frame(target, n, s, {});
    }

    void shape(xml_node n, const scope& s)
    {
        std::vector<outline> outlines = svg_shape(doc_, n, s.viewport);
        if (outlines.empty())
            doc_.leave_out(n, fmt::format("{} draws nothing", doc_.called(n)),
                           "it needs a size, or path data that draws");
        const double scale = std::hypot(s.to_mm.a, s.to_mm.b) * std::hypot(s.to_mm.c, s.to_mm.d);
        if (!(std::abs(s.to_mm.determinant()) > 1e-9 * scale))
            doc_.leave_out(n, fmt::format("{} is flattened by its transform", doc_.called(n)),
                           "a scale of 0 or a skew of 90 degrees leaves no drawing");
        std::vector<path> paths;
        std::size_t look = 0; // equal for equal shapes in equal places
        for (outline& o : outlines) {
            vertices_ += o.vertices.size();
            if (vertices_ > most_vertices)
                doc_.fail(n, "too many points", "simplify the drawing");
            // Looks the place up only for an error: that reads the whole file before it.
            const auto what = [&] { return fmt::format("{}: {}", doc_.where(n).text(), doc_.called(n)); };
            outline placed = mapped(std::move(o), s.to_mm);
            for (const point p : placed.vertices) {
                boost::hash_combine(look, p.x_mm);
                boost::hash_combine(look, p.y_mm);
            }
            paths.push_back(detail::make_path(std::move(placed), what));
            boost::hash_combine(look, paths.back().length_mm());
        }
        keep_drawn(n, paths);
        if (!looks_.insert(look).second && !n.attribute("data-start-s"))
            doc_.note_twice(n);
        if (!s.is_painted())
            doc_.note_unpainted(n);
        add(n, s, paths);
    }

    // Takes out the subpaths that are points. Where all are, a duration makes them taps.
    void keep_drawn(xml_node n, std::vector<path>& paths)
    {
        const auto is_point = [](const path& p) { return p.length_mm() == 0.0; };
        const bool all = std::all_of(paths.begin(), paths.end(), is_point);
        if (all && !n.attribute("data-duration-s"))
            doc_.leave_out(n, fmt::format("{}: has no length", doc_.called(n)),
                           "data-duration-s makes it a tap");
        if (!all && std::erase_if(paths, is_point) != 0)
            doc_.note_left_out({doc_.offset(n), fmt::format("{}: a subpath has no length", doc_.called(n)),
                                "it draws a point"});
    }

    static trajectory eased(const path& p, double duration_s, const scope& s)
    {
        if (s.easing == easing_kind::linear)
            return trajectory::along(p, duration_s, s.intensity);
        return trajectory::along(p, movement{.duration_s = duration_s, .easing = s.easing}, s.intensity);
    }

    // Adds a shape. Its subpaths share its duration by their lengths.
    void add(xml_node n, const scope& s, const std::vector<path>& paths)
    {
        const auto duration = doc_.number(n, "data-duration-s", 1e-6, detail::longest_stroke_s);
        auto start = doc_.number(n, "data-start-s", 0.0, detail::longest_stroke_s);
        if (duration && n.attribute("data-speed-mm-s"))
            doc_.fail(n, fmt::format("{} has data-duration-s and data-speed-mm-s", doc_.called(n)),
                      "give one of the two");
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
                doc_.fail(n, fmt::format("{} takes {:g} s", doc_.called(n), time),
                          "a stroke takes at most a day");
            strokes_.push_back({.name = paths.size() == 1 ? name : fmt::format("{}-{}", name, i + 1),
                                .motion = eased(paths[i], time, s),
                                .start_s = start,
                                .speed_mm_s = duration ? std::nullopt : std::optional(speed),
                                .usual_pace = !duration && !s.speed_mm_s,
                                .sound = {.carrier_hz = s.carrier_hz}});
            start.reset();
        }
    }

    detail::svg_document doc_;
    std::vector<stroke> strokes_;
    std::optional<left_out> left_out_; ///< the first
    std::unordered_set<std::size_t> looks_;
    xml_node hidden_;
    std::size_t elements_ = 0;
    std::size_t vertices_ = 0;
};

} // namespace

std::vector<stroke> parse_strokes_svg(std::string_view text, const std::string& name)
{
    detail::check_size(text, name, detail::max_tree_bytes, "simplify the drawing");
    return svg_reader(text, name).read();
}

} // namespace v0
} // namespace tactor
