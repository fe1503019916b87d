// SPDX-License-Identifier: MIT
/// \file
/// What paints PNG and PDF is a module of its own, for Cairo brings some twenty libraries, which would be
/// loaded whenever the tool starts. Tool and module are of one build: the version is in the module's name.
#pragma once

#include <new>
#include <optional>
#include <string>

#include <tactor/error.hpp>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// A file's bytes, or why there are none. No exception passes from the module to who loaded it: each may have
/// a C++ runtime of its own.
struct painting {
    std::string bytes = {};
    bool no_memory = false;
    std::optional<error_kind> failed = {};
    std::string what = {}, why = {}, hint = {}; ///< where it failed
};

/// What the module exports, as tactor_painter.
struct painter_module {
    painting (*to_png)(const canvas&, unsigned dpi) noexcept;
    painting (*to_pdf)(const canvas&) noexcept;
};

/// \throws error, std::bad_alloc
inline std::string painted_bytes(painting p)
{
    if (p.no_memory)
        throw std::bad_alloc();
    if (p.failed)
        throw error(*p.failed, p.what, p.why, p.hint);
    return std::move(p.bytes);
}

} // namespace tactor::plot
