// SPDX-License-Identifier: MIT
// The look of a line as its intensity, where the drawing asks for it.
#pragma once

#include "files/svg/document.hpp"

namespace tactor::detail {

enum class svg_strength { none, stroke_width, opacity };

/// What is inherited of it. Looks may be written in ways that are not read here, which matters only to those
/// who ask: then the value is no number.
struct svg_look {
    svg_strength asked = svg_strength::none;
    double width = 1.0;          ///< user units
    double opacity = 1.0;        ///< product of those round the element
    double stroke_opacity = 1.0; ///< of the nearest

    double shown() const noexcept { return opacity * stroke_opacity; }
};

/// What the element's own attributes change.
void inherit_svg_look(const svg_document& doc, pugi::xml_node n, const svg_viewport& v, svg_look& look);

/// \throws error (bad_input) naming the shape, where what it asks for is not to be had from its look.
void check_svg_look(const svg_document& doc, pugi::xml_node n, const svg_look& look);

} // namespace tactor::detail
