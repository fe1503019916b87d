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
#include "plot/figure.hpp"
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

plot::bar_series make_bars(const std::string& name, const study::by_motion& b)
{
    plot::bar_series s{name};
    for (std::size_t m = 0; m < b.motion.size(); ++m)
        s.bars.push_back({*b.motion[m].mean, b.motion[m].se, b.motion_values[m]});
    s.bars.push_back({*b.all.mean, b.all.se, b.all_values});
    return s;
}

plot::bar_panel make_panel(const study::run_analysis& r)
{
    plot::bar_panel p;
    p.title = fmt::format("{} (n = {})", r.run.name, r.n);
    p.groups = r.run.motions;
    p.groups.emplace_back("all");
    switch (r.run.task) {
    case study::task_kind::choose:
        p.y_title = fmt::format("{} chosen (%)", r.run.methods.back());
        p.series.push_back(make_bars("", r.cells[0]));
        p.level = 50.0;
        p.y_to = 100.0;
        return p;
    case study::task_kind::rate:
        p.y_title = "mean rating";
        p.y_from = 1.0;
        p.y_to = r.run.scale;
        break;
    case study::task_kind::identify:
        p.y_title = "correct (%)";
        p.level = study::chance(r.run);
        p.y_to = 100.0;
        break;
    }
    for (std::size_t m = 0; m < r.run.methods.size(); ++m)
        p.series.push_back(make_bars(r.run.methods[m], r.cells[m]));
    return p;
}

// Draws means with standard errors and each participant by motion, a panel for each run, as the paper's
// figures 8 and 9.
plot::canvas draw_analysis(const study::analysis& a, const picture_options& o)
{
    plot::bar_figure f;
    f.title = o.choose_title(a.experiment);
    f.heading = o.has_title();
    f.width_mm = o.width_mm;
    f.note = "Means over participants; error bars: standard errors; dots: participants.";
    f.across = a.simulated ? "simulated" : "";
    for (const study::run_analysis& r : a.runs)
        if (r.n != 0)
            f.panels.push_back(make_panel(r));
    return plot::draw_bar_figure(f);
}

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
        print_trials(d);
    else
        print_analysis_text(a);
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
