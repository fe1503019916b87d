// SPDX-License-Identifier: MIT
/// \file
/// Options of every picture.
#pragma once

#include <string>

#include "plot/figure.hpp"
#include "plot/paint/output.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

struct picture_options {
    std::string file = {}; ///< empty: none
    double width_mm = plot::figure_options{}.width_mm;
    unsigned dpi = plot::usual_dpi;
    bool force = false;     ///< replaces a file that tactor did not write
    std::string title = {}; ///< --title; empty: the picture's own, "none": none

    bool has_title() const { return title != "none"; }
    /// Returns the title that is asked for, or `own`.
    std::string choose_title(const std::string& own) const { return title.empty() ? own : title; }
};

/// Adds --width, --dpi, --title and --force. `usual_width`: words for the help.
void add_picture_options(CLI::App& command, picture_options& into, const std::string& usual_width);

} // namespace tactor::cli
