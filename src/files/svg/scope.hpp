// SPDX-License-Identifier: MIT
// Properties that an SVG element inherits from those round it.
#pragma once

#include <optional>

#include <tactor/stroke.hpp>

#include "files/svg/document.hpp"

namespace tactor::detail {

struct svg_scope {
    affine to_mm;
    svg_viewport viewport;
    std::optional<double> speed_mm_s;
    double intensity = 1.0;
    bool visible = true; ///< visibility, which those inside may set anew; unlike display
    std::optional<double> carrier_hz;
    easing_kind easing = easing_kind::linear;
    bool filled = true;
    bool outlined = false;
    bool clear = false; ///< an opacity of 0, of its own or round it
    unsigned depth = 0; ///< elements round this one
    unsigned uses = 0;  ///< of these, <use>

    bool is_painted() const noexcept { return (filled || outlined) && !clear; }
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
