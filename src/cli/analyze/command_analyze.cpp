// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "cli/analyze/analyze_output.hpp"
#include "cli/analyze/study_options.hpp"
#include "cli/commands.hpp"
#include "cli/picture_options.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "plot/paint/output.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

struct analyze_options {
    std::string folder;
    std::string format = "text";
    picture_options picture{.width_mm = 170.0};
    study::selection who;
};

void draw(const analyze_options& o, const study::analysis& a)
{
    if (std::all_of(a.runs.begin(), a.runs.end(), [](const study::run_analysis& r) { return r.n == 0; }))
        throw error(error_kind::bad_input, "-o", "there is nothing to draw",
                    "no run has a participant with a trial in each cell");
    plot::check_output(o.picture.file, o.picture.force);
    make_derivatives(o.folder, o.picture.file);
    session::tell_of_pipe_to_write(o.picture.file);
    plot::save(draw_analysis(a, o.picture), o.picture.file, o.picture.dpi, o.picture.force);
}

/// Prints the warnings about participants, and the first of those about missing figures, which the text shows
/// as dashes.
void print_warnings(const std::vector<std::string>& warnings)
{
    const auto is_of_figure = [](const std::string& w) {
        return w.rfind("sub-", 0) != 0 && w.find(": sub-") == std::string::npos;
    };
    const auto figures = std::count_if(warnings.begin(), warnings.end(), is_of_figure);
    bool first = true;
    for (const std::string& w : warnings) {
        if (!is_of_figure(w)) {
            say(stderr, "tactor: warning: {}\n", w);
        } else if (std::exchange(first, false)) {
            const std::string more =
                figures == 1 ? ""
                             : fmt::format(" ({}: --format json)",
                                           counted(static_cast<std::uint64_t>(figures - 1), "more warning"));
            say(stderr, "tactor: warning: {}{}\n", w, more);
        }
    }
}

int run(const analyze_options& o)
{
    const study::dataset d = study::read_dataset(o.folder, o.who);
    const study::analysis a = study::analyse(d);
    if (!o.picture.file.empty())
        draw(o, a);
    print_warnings(a.warnings);
    if (o.format == "json")
        print_analysis_json(stdout, a);
    else if (o.format == "tsv")
        print_trials(stdout, d);
    else
        print_analysis_text(stdout, a);
    return status_ok;
}

} // namespace

command add_analyze(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("analyze", "Print the statistics of a study");
    auto o = std::make_shared<analyze_options>();
    add_study_options(*c, o->folder, o->who);
    add_format_option(*c, o->format, {"text", "json", "tsv"},
                      "format of the output; tsv has a line for each trial, for R (default text)");
    add_text(*c, "-o,--output", "FILE.svg|.png|.pdf",
             "also draw means with standard errors, and each participant", [o](const std::string& t) {
                 plot::find_format(t);
                 o->picture.file = t;
             });
    add_picture_options(*c, o->picture, "170, the width of a page");
    c->footer("tactor analyze study\n"
              "tactor analyze study --format json -o study.pdf\n"
              "tactor analyze study --exclude 07:illness");
    return [o] { return run(*o); };
}

} // namespace tactor::cli
