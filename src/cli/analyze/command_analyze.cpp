// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "cli/analyze/analyze_output.hpp"
#include "cli/analyze/study_options.hpp"
#include "cli/commands.hpp"
#include "cli/picture_options.hpp"
#include "cli/settings.hpp"
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

int run(const analyze_options& o)
{
    const study::dataset d = study::read_dataset(o.folder, o.who);
    const study::analysis a = study::analyse(d);
    if (!o.picture.file.empty())
        draw(o, a);
    print_warnings(a);
    if (o.format == "json")
        fmt::print("{}\n",
                   make_analysis_json(a).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
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
