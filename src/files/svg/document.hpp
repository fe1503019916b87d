// SPDX-License-Identifier: MIT
// An SVG document whose messages have a line and a column, and its shapes.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <fmt/format.h>
#include <pugixml.hpp>

#include <tactor/error.hpp>

#include "core/path/impl.hpp"
#include "core/path/shape.hpp"
#include "core/split.hpp"

namespace tactor::detail {

inline constexpr double mm_per_px = 25.4 / 96.0;

struct svg_length {
    double value = 0.0; ///< mm, or user units
    bool in_mm = false;
};

struct svg_view_box {
    point corner;
    double width = 0.0;
    double height = 0.0;
};

/// Reads a length. Throws value_fault, as do all readers of values here.
svg_length parse_svg_length(std::string_view text);
svg_view_box parse_svg_view_box(std::string_view text);
/// Reads a list of transforms in small letters, also with the units deg and px, as in styles. A px is a user
/// unit, as in browsers.
affine parse_svg_transform(std::string_view text);

/// A fault because of which an element is left out. The other elements play.
struct omission {
    std::optional<std::size_t> offset; ///< in the document
    std::string why;
    std::string hint; ///< the same for each fault of a kind
};

/// Properties that decide which elements play and where, or that browsers show.
inline constexpr std::array<std::string_view, 30> svg_properties{
    // Followed:
    "fill", "stroke", "opacity", "fill-opacity", "stroke-opacity", "stroke-width", "display", "visibility",
    "transform",
    // Not followed:
    "transform-origin", "transform-box", "clip-path", "mask", "filter",
    // Not followed in styles; attributes of these names are geometry, or mean nothing:
    "-webkit-transform", "translate", "rotate", "scale", "animation", "animation-name", "width", "height",
    "x", "y", "cx", "cy", "r", "rx", "ry", "d"};
inline constexpr std::size_t svg_paints = 6;     ///< number of properties at the beginning that only paint
inline constexpr std::size_t svg_display = 6;    ///< "display"
inline constexpr std::size_t svg_visibility = 7; ///< "visibility"
inline constexpr std::size_t svg_followed = 9;   ///< number of properties at the beginning that are followed
inline constexpr std::size_t svg_attributes =
    14; ///< number of properties at the beginning that are presentation attributes

/// The svg_properties of one element, from its attributes and from its own style, which wins.
class svg_style {
public:
    explicit svg_style(pugi::xml_node n);

    /// Returns a value in small letters and without !important; empty for none.
    std::string_view value(std::string_view property) const;

private:
    std::map<std::string_view, std::string> values_;
};

class svg_document {
public:
    /// Parses a document. Reads nothing outside the text.
    /// \throws error (bad_input) if it is not well-formed.
    svg_document(std::string_view text, const std::string& name);

    pugi::xml_node root() const { return tree_.document_element(); }
    pugi::xml_node by_id(std::string_view id) const;

    /// Returns true if rules of <style> may paint.
    bool has_rules() const noexcept { return has_rules_; }
    /// Returns true if a rule for a class of the element has display: none.
    bool hides(pugi::xml_node n) const;

    std::optional<std::size_t> offset(pugi::xml_node n) const;
    source_place where(pugi::xml_node n) const { return place(offset(n)); }

    /// Returns "<path> 'left'" for messages.
    static std::string called(pugi::xml_node n);

    [[noreturn]] void fail(pugi::xml_node n, std::string_view why, std::string_view hint) const;
    error to_error(const omission& f) const;
    [[noreturn]] void leave_out(pugi::xml_node n, std::string why, std::string hint) const;

    /// Returns `parse` of an attribute's text; nothing if it is missing.
    template <class F>
    auto read(pugi::xml_node n, const char* attribute, F parse) const
        -> std::optional<decltype(parse(std::string_view{}))>
    {
        const pugi::xml_attribute a = n.attribute(attribute);
        if (!a)
            return std::nullopt;
        try {
            return parse(std::string_view(a.value()));
        } catch (const value_fault& f) {
            throw to_error(fault(n, a, f)).with_field(attribute);
        }
    }

    /// Returns `parse` of the text of an attribute or property. Returns nothing if it is empty, and if it
    /// cannot be read: notes that, because browsers ignore it, too.
    template <class F>
    auto follow(pugi::xml_node n, std::string_view name, std::string_view text, F parse) const
        -> std::optional<decltype(parse(text))>
    {
        try {
            return text.empty() ? std::nullopt : std::optional(parse(text));
        } catch (const value_fault& f) {
            note_unfollowed(n, name, fmt::format(" ({})", f.why));
            return std::nullopt;
        }
    }

    /// Reads a length in user units, of which a millimetre has `per_mm`; 0 if it is missing.
    /// \throws value_fault
    double length(pugi::xml_node n, const char* attribute, double per_mm) const;

    /// Reads a number from low to high.
    std::optional<double> number(pugi::xml_node n, const char* attribute, double low, double high) const;

    /// Adds a warning: the place, `text` and `end`. If several have the same key, only the first is shown; it
    /// counts the others.
    void note(std::optional<std::size_t> offset, std::string_view key, std::string text,
              const char* end) const;
    void note_unfollowed(pugi::xml_node n, std::string_view what, std::string_view why = {}) const;
    std::vector<std::string> warnings() const;

private:
    struct noted {
        std::optional<std::size_t> offset;
        std::string text;
        const char* end = "";
        std::size_t elements = 0;
    };

    source_place place(std::optional<std::size_t> offset) const;
    omission fault(pugi::xml_node n, pugi::xml_attribute a, const value_fault& f) const;
    void note_rules(pugi::xml_node style);
    void note_other_file(pugi::xml_node n, std::string_view what) const;
    /// Keeps the classes of ".st0, .st1" as hidden. Returns false for selectors that are not only classes.
    bool add_hidden(std::string_view selectors);

    std::string_view text_;
    const std::string& name_;
    std::string buffer_; ///< the tree points into it
    pugi::xml_document tree_;
    std::unordered_map<std::string_view, pugi::xml_node> ids_;
    bool has_rules_ = false;
    std::unordered_set<std::string_view> hidden_; ///< classes; views of names in the tree
    mutable std::map<std::string, noted, std::less<>> notes_;
};

/// Returns the element's name without the prefix "svg:".
std::string_view svg_tag(pugi::xml_node n);

/// Returns true for the tags that svg_shape() takes.
bool is_svg_shape(std::string_view tag) noexcept;

/// Returns the subpaths of a shape in user units, of which a millimetre has `per_mm`. Returns none for a
/// shape that SVG does not draw (no data, a radius or a side of 0).
/// \throws error (bad_input), value_fault
std::vector<outline> svg_shape(const svg_document& doc, pugi::xml_node n, double per_mm);

} // namespace tactor::detail
