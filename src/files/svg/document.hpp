// SPDX-License-Identifier: MIT
// An SVG document whose complaints have a line and a column, and its shapes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

#include <tactor/error.hpp>

#include "core/path/number.hpp"
#include "core/path/outline.hpp"
#include "files/svg/style.hpp"
#include "files/svg/values.hpp"

namespace tactor::detail {

class svg_document {
public:
    /// Entities of the document's own are not expanded and nothing outside it is read.
    /// \throws error (bad_input) for what is not well-formed.
    svg_document(std::string_view text, const std::string& name);

    pugi::xml_node root() const { return tree_.document_element(); }
    pugi::xml_node by_id(std::string_view id) const;
    const std::string& name() const noexcept { return name_; }

    source_place where(pugi::xml_node n) const;

    /// Returns "<path> 'left'" for messages.
    static std::string called(pugi::xml_node n);

    [[noreturn]] void fail(pugi::xml_node n, std::string_view why, std::string_view hint) const;

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
            fail(n, a, f);
        }
    }

    /// Returns `parse` of a property of svg_properties, by its attribute, style or rules; nothing where it
    /// is not set.
    template <class F>
    auto read_property(pugi::xml_node n, const char* name, F parse) const
        -> std::optional<decltype(parse(std::string_view{}))>
    {
        const std::string_view text = property(n, name);
        if (text.empty())
            return std::nullopt;
        try {
            return parse(text);
        } catch (const value_fault& f) {
            fail(n, name, text, f);
        }
    }

    /// Returns the text of a property of svg_properties; empty if it is not set.
    std::string_view property(pugi::xml_node n, std::string_view name) const;

    /// Remembers that something of an element is not followed: once for each `what`.
    void note(pugi::xml_node n, const std::string& what) const;
    /// Names features that are not followed, with places.
    std::vector<std::string> warnings() const;

    /// Reads a length in user units.
    double length(pugi::xml_node n, const char* attribute, const svg_viewport& v, svg_extent e,
                  double otherwise = 0.0) const;

    /// Reads a number from low to high.
    std::optional<double> number(pugi::xml_node n, const char* attribute, double low, double high) const;

private:
    struct note_count {
        pugi::xml_node first;
        std::size_t elements = 0;
    };

    [[noreturn]] void fail(pugi::xml_node n, pugi::xml_attribute a, const value_fault& f) const;
    [[noreturn]] void fail(pugi::xml_node n, const char* property, std::string_view text,
                           value_fault f) const;

    std::string_view text_;
    const std::string& name_;
    std::string buffer_; ///< the tree lives in it
    pugi::xml_document tree_;
    std::unordered_map<std::string_view, pugi::xml_node> ids_;
    svg_style_sheet sheet_;
    mutable std::map<std::string, note_count> notes_;
};

/// Returns the element's name without the prefix "svg:".
std::string_view svg_tag(pugi::xml_node n);

/// Returns true for the tags that svg_shape() takes.
bool is_svg_shape(std::string_view tag) noexcept;

/// Returns the subpaths of a shape in user units; none for a shape that SVG does not draw (no data, a radius
/// or a side of 0). \throws error (bad_input)
std::vector<outline> svg_shape(const svg_document& doc, pugi::xml_node n, const svg_viewport& v);

} // namespace tactor::detail
