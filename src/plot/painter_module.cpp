// SPDX-License-Identifier: MIT
// The entry of the module that paints with Cairo.
#include "plot/painter_module.hpp"

#include "plot/output.hpp"

extern "C" __attribute__((visibility("default")))
const tactor::plot::painter_module tactor_painter{tactor::plot::to_png, tactor::plot::to_pdf};
