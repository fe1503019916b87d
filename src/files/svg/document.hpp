// SPDX-License-Identifier: MIT
// An SVG document, whose error messages contain line and column, and its shapes.
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
    double value = 0.0; ///< number in mm, or in user units
    bool in_mm = false;
};

struct svg_view_box {
    point corner;
    double width = 0.0;
    double height = 0.0;
};

/// Reads a length. Like all functions here that parse values, throws value_fault.
svg_length parse_svg_length(std::string_view text);
svg_view_box parse_svg_view_box(std::string_view text);
/// Reads a list of transforms in lower case. Numbers may have the units deg and px, as in styles. As in
/// browsers, a px is a user unit.
affine parse_svg_transform(std::string_view text);

/// A fault that excludes one element. The other elements are played.
struct omission {
    std::optional<std::size_t> offset; ///< offset in the document
    std::string why;
    std::string hint; ///< equal for all faults of a kind
};

/// Properties that decide which elements are played and where, or that change what browsers show.
inline constexpr std::array<std::string_view, 30> svg_properties{
    // Properties that tactor supports:
    "fill", "stroke", "opacity", "fill-opacity", "stroke-opacity", "stroke-width", "display", "visibility",
    "transform",
    // Properties that tactor does not support:
    "transform-origin", "transform-box", "clip-path", "mask", "filter",
    // Properties that tactor does not support in styles. As attributes they are geometry or have no meaning:
    "-webkit-transform", "translate", "rotate", "scale", "animation", "animation-name", "width", "height",
    "x", "y", "cx", "cy", "r", "rx", "ry", "d"};
inline constexpr std::size_t svg_paints = 6;     ///< number of leading properties that only affect painting
inline constexpr std::size_t svg_display = 6;    ///< index of "display"
inline constexpr std::size_t svg_visibility = 7; ///< index of "visibility"
inline constexpr std::size_t svg_followed = 9;   ///< number of leading properties that are supported
inline constexpr std::size_t svg_attributes =
    14; ///< number of leading properties that are also presentation attributes

/// The svg_properties of one element, from its attributes and its style attribute. The style overrides
/// attributes.
class svg_style {
public:
    explicit svg_style(pugi::xml_node n);

    /// Returns a value in lower case, without !important. Returns "" if the property is not set.
    std::string_view value(std::string_view property) const;

private:
    std::map<std::string_view, std::string> values_;
};

class svg_document {
public:
    /// Parses a document. Reads no other files.
    /// \throws error (bad_input) if the document is not well-formed.
    svg_document(std::string_view text, const std::string& name);

    pugi::xml_node root() const { return tree_.document_element(); }
    pugi::xml_node by_id(std::string_view id) const;

    /// Returns true if rules of <style> may affect painting.
    bool has_rules() const noexcept { return has_rules_; }
    /// Returns true if a rule with display: none applies to a class of the element.
    bool hides(pugi::xml_node n) const;

    std::optional<std::size_t> offset(pugi::xml_node n) const;
    source_place where(pugi::xml_node n) const { return place(offset(n)); }

    /// Returns the element's name for messages: "<path> 'left'".
    static std::string element_text(pugi::xml_node n);

    [[noreturn]] void fail(pugi::xml_node n, std::string_view why, std::string_view hint) const;
    error to_error(const omission& f) const;
    [[noreturn]] void leave_out(pugi::xml_node n, std::string why, std::string hint) const;

    /// Returns the result of `parse` for an attribute's text, or nothing if the attribute is missing.
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

    /// Returns the result of `parse` for the text of an attribute or property, or nothing if the text is
    /// empty. If the text cannot be parsed, adds a warning and returns nothing, because browsers also ignore
    /// such values.
    template <class F>
    auto parse_or_warn(pugi::xml_node n, std::string_view name, std::string_view text, F parse) const
        -> std::optional<decltype(parse(text))>
    {
        try {
            return text.empty() ? std::nullopt : std::optional(parse(text));
        } catch (const value_fault& f) {
            warn_of_unsupported(n, name, fmt::format(" ({})", f.why));
            return std::nullopt;
        }
    }

    /// Reads a length in user units. A millimetre has `per_mm` user units. Returns 0 if the attribute is
    /// missing.
    /// \throws value_fault
    double length(pugi::xml_node n, const char* attribute, double per_mm) const;

    /// Reads a number in the range from `low` to `high`.
    std::optional<double> number(pugi::xml_node n, const char* attribute, double low, double high) const;

    /// Adds a warning, which consists of the place, `text` and `end`. Of warnings with the same key only the
    /// first is shown, with the number of the others.
    void note(std::optional<std::size_t> offset, std::string_view key, std::string text,
              const char* end) const;
    void warn_of_unsupported(pugi::xml_node n, std::string_view what, std::string_view why = {}) const;
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
    void read_style_rules(pugi::xml_node style);
    void warn_of_other_file(pugi::xml_node n, std::string_view what) const;
    /// Records the classes of a selector list such as ".st0, .st1" as hidden. Returns false if the list also
    /// has other selectors.
    bool add_hidden_classes(std::string_view selectors);

    std::string_view text_;
    const std::string& name_;
    std::string buffer_; ///< text into which the nodes of the tree point
    pugi::xml_document tree_;
    std::unordered_map<std::string_view, pugi::xml_node> ids_;
    bool has_rules_ = false;
    std::unordered_set<std::string_view> hidden_; ///< hidden classes; views of text in the tree
    mutable std::map<std::string, noted, std::less<>> notes_;
};

/// Returns the element's name without the prefix "svg:", if it has this prefix.
std::string_view svg_tag(pugi::xml_node n);

/// Returns true for the tags that svg_shape() supports.
bool is_svg_shape(std::string_view tag) noexcept;

/// Returns the subpaths of a shape in user units. A millimetre has `per_mm` user units. Returns none for a
/// shape that SVG does not draw: a shape without data, or with a radius or a side of 0.
/// \throws error (bad_input), value_fault
std::vector<outline> svg_shape(const svg_document& doc, pugi::xml_node n, double per_mm);

} // namespace tactor::detail
