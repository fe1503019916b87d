// SPDX-License-Identifier: MIT
/// \file
/// What paints PNG and PDF is a module of its own, for Cairo brings some twenty libraries, which would be
/// loaded whenever the tool starts. Tool and module are of one build: the version is in the module's name.
#pragma once

#include <string>

#include "plot/canvas.hpp"

namespace tactor::plot {

/// What the module exports, as tactor_painter.
struct painter_module {
    std::string (*to_png)(const canvas&, unsigned dpi);
    std::string (*to_pdf)(const canvas&);
};

} // namespace tactor::plot
