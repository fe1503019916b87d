// SPDX-License-Identifier: MIT
/// \file
/// The module that paints PNG and PDF. Cairo brings some twenty libraries, which would slow down each start
/// of the tool. Tool and module must be from the same build, so the module's name contains the version.
#pragma once

#include <optional>
#include <string>

#include <tactor/error.hpp>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Bytes of a file, or the reason why there are none. No exception leaves the module: it may have another C++
/// runtime than the program that loaded it.
struct painting {
    std::string bytes = {};
    bool no_memory = false;
    std::optional<error_kind> failed = {};
    std::string what = {}, why = {}, hint = {}; ///< parts of the error after a failure
};

/// Functions that the module exports as tactor_painter.
struct painter_module {
    painting (*to_png)(const canvas&, unsigned dpi) noexcept;
    painting (*to_pdf)(const canvas&) noexcept;
};

} // namespace tactor::plot
