// SPDX-License-Identifier: MIT
// What an SVG element inherits from those round it.
#pragma once

#include <optional>

#include <tactor/movement.hpp>

#include "files/svg/document.hpp"
#include "files/svg/strength.hpp"

namespace tactor::detail {

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

/// A document with a size in physical units is as large as it says. In any other, one user unit is one
/// millimetre and coordinates are as they stand.
svg_scope svg_root_scope(const svg_document& doc);

/// Inside an element that has this view box: the box fills width x height (user units) from `corner`.
void enter_svg_box(const svg_document& doc, pugi::xml_node n, svg_scope& s, const svg_view_box& box,
                   point corner, double width, double height);

/// What the element's own attributes change: transform, visibility and data-...
void inherit_svg(const svg_document& doc, pugi::xml_node n, svg_scope& s);

/// display is "none".
bool svg_hidden(const svg_document& doc, pugi::xml_node n);

} // namespace tactor::detail
