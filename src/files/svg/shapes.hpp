// SPDX-License-Identifier: MIT
// The basic shapes of SVG as outlines: https://www.w3.org/TR/SVG2/shapes.html
#pragma once

#include <vector>

#include "core/path/outline.hpp"
#include "files/svg/document.hpp"

namespace tactor::detail {

bool is_svg_shape(std::string_view tag) noexcept;

/// The subpaths of a shape in user units; none for a shape that SVG does not draw (no data, a radius or a
/// side of 0). \throws error (bad_input)
std::vector<outline> svg_shape(const svg_document& doc, pugi::xml_node n, const svg_viewport& v);

} // namespace tactor::detail
