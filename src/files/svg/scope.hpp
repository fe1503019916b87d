// SPDX-License-Identifier: MIT
// Properties that an SVG element inherits from those round it, and the look of a line as its intensity, if
// the drawing asks for that.
#pragma once

#include <optional>

#include <tactor/stroke.hpp>

#include "files/svg/document.hpp"

namespace tactor::detail {

enum class svg_strength { none, stroke_width, opacity };

/// The part of a look that elements inherit. Looks may be written in ways that are not read here, which
/// matters only to those who ask: then the value is no number.
struct svg_look {
    svg_strength asked = svg_strength::none;
    double width = 1.0;          ///< user units
    double opacity = 1.0;        ///< product of those round the element
    double stroke_opacity = 1.0; ///< of the nearest
    bool filled = true;
    bool outlined = false;

    double shown() const noexcept { return opacity * stroke_opacity; }
    bool is_painted() const noexcept { return (filled || outlined) && opacity != 0.0; }
};

/// Applies the element's own attributes to the look.
void inherit_svg_look(const svg_document& doc, pugi::xml_node n, const svg_viewport& v, svg_look& look);

/// Checks a look. \throws error (bad_input) naming the shape, where its look does not give what it asks for.
void check_svg_look(const svg_document& doc, pugi::xml_node n, const svg_look& look);

struct svg_scope {
    affine to_mm;
    svg_viewport viewport;
    std::optional<double> speed_mm_s;
    double intensity = 1.0;
    bool visible = true; ///< visibility, which those inside may set anew; unlike display
    std::optional<double> carrier_hz;
    easing_kind easing = easing_kind::linear;
    svg_look look;
    unsigned depth = 0; ///< elements round this one
    unsigned uses = 0;  ///< of these, <use>
};

/// Returns the scope inside the root. A document with a size in physical units is as large as it says. In any
/// other, one user unit is one millimetre and coordinates are as they stand.
svg_scope svg_root_scope(const svg_document& doc);

/// Enters an element with a view box: the box fills width x height (user units) from `corner`.
void enter_svg_box(const svg_document& doc, pugi::xml_node n, svg_scope& s, const svg_view_box& box,
                   point corner, double width, double height);

/// Applies the element's own attributes: transform, visibility and data-...
void inherit_svg(const svg_document& doc, pugi::xml_node n, svg_scope& s);

/// Returns true if display is "none", or not understood, which is noted.
bool svg_hidden(const svg_document& doc, pugi::xml_node n);

} // namespace tactor::detail
