// SPDX-License-Identifier: MIT
/// \file
/// Paints a canvas with Cairo.
#pragma once

#include <memory>

#include <cairo.h>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

struct surface_closer {
    void operator()(cairo_surface_t* s) const noexcept { cairo_surface_destroy(s); }
};
using surface_ptr = std::unique_ptr<cairo_surface_t, surface_closer>;

/// Paints on white; `scale` is units of the surface to the point. \throws error (runtime).
void paint(const canvas& c, cairo_surface_t* surface, double scale);

/// \throws error (runtime) unless the status is success.
void check(cairo_status_t status);

} // namespace tactor::plot
