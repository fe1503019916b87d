// SPDX-License-Identifier: MIT
#include "cli/picture_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/settings.hpp"
#include "options/option.hpp"
#include "plot/paint/output.hpp"

namespace tactor::cli {

void add_picture_options(CLI::App& command, picture_options& into, const std::string& usual_width)
{
    begin_group(command, "Picture");
    add_text(command, "--width", "MM", fmt::format("width of the picture (default {})", usual_width),
             [&into](const std::string& t) {
                 into.width_mm =
                     options::parse_number("--width", t, {plot::least_width_mm, plot::most_width_mm}, "mm");
             });
    add_text(command, "--dpi", "N", "resolution of a PNG (default 300)", [&into](const std::string& t) {
        into.dpi =
            static_cast<unsigned>(options::parse_whole("--dpi", t, {plot::least_dpi, plot::most_dpi}, "dpi"));
    });
    command.add_option("--title", into.title, "title of the picture; none leaves the heading out")
        ->type_name("TEXT|none");
    begin_group(command);
    add_force_option(command, into.force);
}

} // namespace tactor::cli
