// SPDX-License-Identifier: MIT
// An SVG document whose complaints have a line and a column, and its shapes.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>
#include <pugixml.hpp>

#include <tactor/error.hpp>

#include "core/path/number.hpp"
#include "core/path/outline.hpp"
#include "files/svg/style.hpp"
#include "files/svg/values.hpp"

namespace tactor::detail {

/// A fault for which an element is left out. The other elements play.
struct left_out {
    std::optional<std::size_t> offset; ///< in the document
    std::string why;
    std::string hint; ///< one for each kind of fault
};

class svg_document {
public:
    /// Expands the document's own entities in styles only, and reads nothing outside it.
    /// \throws error (bad_input) for what is not well-formed.
    svg_document(std::string_view text, const std::string& name);

    pugi::xml_node root() const { return tree_.document_element(); }
    pugi::xml_node by_id(std::string_view id) const;
    const std::string& name() const noexcept { return name_; }

    std::optional<std::size_t> offset(pugi::xml_node n) const;
    source_place where(pugi::xml_node n) const;

    /// Returns "<path> 'left'" for messages.
    static std::string called(pugi::xml_node n);

    [[noreturn]] void fail(pugi::xml_node n, std::string_view why, std::string_view hint) const;
    error to_error(const left_out& f) const;
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

    /// Returns `parse` of the text of an attribute or property; nothing where it is empty, and where it
    /// cannot be read, which is noted: browsers ignore it, too.
    template <class F>
    auto follow(pugi::xml_node n, const char* name, std::string_view text, F parse) const
        -> std::optional<decltype(parse(text))>
    {
        try {
            return text.empty() ? std::nullopt : std::optional(parse(text));
        } catch (const value_fault& f) {
            note_unfollowed(n, name, fmt::format(" ({})", f.why));
            return std::nullopt;
        }
    }

    /// Returns the text of a property of svg_properties, as svg_style_sheet::value() does.
    std::string_view property(pugi::xml_node n, std::string_view name) const;

    // Note something for warnings(), which name the first element and count the others.
    void note_unfollowed(pugi::xml_node n, const std::string& what, std::string_view why = {}) const;
    void note_strength(pugi::xml_node n) const;
    void note_unknown(pugi::xml_node n, const char* property, std::string_view value) const;
    void note_no_shape(pugi::xml_node n) const;
    void note_twice(pugi::xml_node n) const;
    void note_unpainted(pugi::xml_node n) const;
    void note_left_out(const left_out& f) const;

    /// Returns warnings: what was noted, with places.
    std::vector<std::string> warnings() const;

    /// Reads a length in user units. \throws left_out
    double length(pugi::xml_node n, const char* attribute, const svg_viewport& v, svg_extent e,
                  double otherwise = 0.0) const;

    /// Reads a number from low to high.
    std::optional<double> number(pugi::xml_node n, const char* attribute, double low, double high) const;

private:
    /// A warning about one element, or several.
    struct noted {
        std::string begin;
        const char* more = ""; ///< between, if there are more: ", nor of"
        const char* end = "";
        std::size_t elements = 0;
    };

    left_out fault(pugi::xml_node n, pugi::xml_attribute a, const value_fault& f) const;
    template <class F>
    void note(const std::string& key, const char* more, const char* end, F begin) const;

    std::string_view text_;
    const std::string& name_;
    std::string buffer_; ///< the tree lives in it
    pugi::xml_document tree_;
    std::unordered_map<std::string_view, pugi::xml_node> ids_;
    svg_style_sheet sheet_;
    mutable std::map<std::string, noted> notes_;
};

/// Returns the element's name without the prefix "svg:".
std::string_view svg_tag(pugi::xml_node n);

/// Returns true for the tags that svg_shape() takes.
bool is_svg_shape(std::string_view tag) noexcept;

/// Returns the subpaths of a shape in user units; none for a shape that SVG does not draw (no data, a radius
/// or a side of 0). \throws error (bad_input), left_out
std::vector<outline> svg_shape(const svg_document& doc, pugi::xml_node n, const svg_viewport& v);

} // namespace tactor::detail
