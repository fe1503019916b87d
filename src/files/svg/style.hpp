// SPDX-License-Identifier: MIT
// CSS of an SVG document, as far as drawing programs write it: rules for tags, classes and ids.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

namespace tactor::detail {

/// Properties that decide what plays, where and how strongly, or that would if this reader followed them.
inline constexpr std::array<std::string_view, 30> svg_properties{
    // Followed:
    "fill", "stroke", "display", "visibility", "opacity", "transform", "transform-origin", "transform-box",
    // Not followed:
    "clip-path", "mask", "filter",
    // Not followed in styles and rules; attributes of these names are geometry, or mean nothing:
    "translate", "rotate", "scale", "zoom", "offset", "offset-path", "animation", "animation-name",
    "content-visibility", "width", "height", "x", "y", "cx", "cy", "r", "rx", "ry", "d"};
inline constexpr std::size_t svg_paints = 2;      ///< of these, properties that decide only what is seen
inline constexpr std::size_t svg_attributes = 11; ///< of these, presentation attributes
/// Properties that this reader follows for no element, but width and height for the outermost svg.
inline constexpr std::span unfollowed_svg_properties(svg_properties.data() + 8, svg_properties.size() - 8);

/// Returns true for the keywords that display or visibility may be, in small letters.
bool is_svg_keyword(std::string_view property, std::string_view value);

/// The rules of all <style> elements of a document, whose text must live as long.
class svg_style_sheet {
public:
    /// A rule that is not followed although it has one of these properties.
    struct skipped {
        pugi::xml_node style;
        std::string what; ///< a selector, or the name of an at-rule
    };

    void add(pugi::xml_node style);

    /// Adds the entities of a document type declaration. Illustrator keeps styles in them.
    void add_entities(std::string_view doctype);

    /// Notes a style sheet in another file.
    void add_other_file(pugi::xml_node n) { skip(n, "xml-stylesheet"); }

    /// Returns the value of a property of svg_properties for an element: of its attribute, the sheet's rules
    /// and its style, the one that counts by CSS; in small letters, without blanks, comments and !important,
    /// empty for none. A value that no browser takes counts only where there is no other. Valid until a value
    /// of another element is asked for. \throws value_fault for a sheet that matches without end.
    const std::string& value(pugi::xml_node n, std::string_view property) const;

    /// Returns the rules that are not followed, each once.
    const std::vector<skipped>& not_followed() const noexcept { return skipped_; }

private:
    struct declaration {
        std::size_t property = 0; ///< of svg_properties
        std::string_view value;
        bool important = false;
    };
    /// "path.thin#a": all of it must fit.
    struct selector {
        std::string_view tag; ///< empty for any
        std::vector<std::string_view> ids;
        std::vector<std::string_view> classes;
        std::size_t rank = 0;  ///< specificity
        std::size_t first = 0; ///< of declarations_
        std::size_t count = 0;
    };

    void add_rules(pugi::xml_node style, std::string_view css);
    void add_rule(pugi::xml_node style, std::string_view selectors, std::string_view body);
    void skip(pugi::xml_node style, std::string_view what);
    static bool parse_selector(std::string_view text, selector& into);
    static std::vector<declaration> parse_declarations(std::string_view body);
    static bool fits(const selector& s, pugi::xml_node n);
    std::string expand(std::string_view style) const;
    void find_values(pugi::xml_node n) const;

    std::deque<std::string> texts_; ///< without comments
    std::vector<declaration> declarations_;
    std::vector<selector> selectors_; ///< in the order of the document
    /// Selectors by an id, class or tag that they need, with its sign: "#a", ".b", "c", or "" for none.
    std::unordered_map<std::string, std::vector<std::size_t>> by_key_;
    std::unordered_map<std::string_view, std::string_view> entities_;
    std::vector<skipped> skipped_;
    mutable std::size_t tried_ = 0;
    mutable pugi::xml_node valued_; ///< the element that has values_
    mutable std::array<std::string, svg_properties.size()> values_;
};

} // namespace tactor::detail
