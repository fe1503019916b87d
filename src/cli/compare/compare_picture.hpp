// SPDX-License-Identifier: MIT
/// \file
/// A comparison as a picture.
#pragma once

#include <tactor/array.hpp>

#include "cli/compare/compare_rows.hpp"
#include "cli/picture_options.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::cli {

/// Target and predictions on the array, and speeds over time; of rows that kept their samples. \throws error
/// as plot::draw_comparison() does.
plot::canvas picture_of(const comparison& c, const array& a, const picture_options& o);

} // namespace tactor::cli
