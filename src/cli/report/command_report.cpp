// SPDX-License-Identifier: MIT
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/analyze/analyze_output.hpp"
#include "cli/analyze/study_options.hpp"
#include "cli/commands.hpp"
#include "cli/settings.hpp"
#include "session/pipes.hpp"
#include "study/report/methods.hpp"

namespace tactor::cli {
namespace {

struct report_options {
    std::string folder;
    std::string file; // empty: standard output
    bool force = false;
    study::selection who;
};

int run(const report_options& o)
{
    const study::dataset d = study::read_dataset(o.folder, o.who);
    const study::study_facts f = study::read_facts(o.folder, d);
    const study::analysis a = study::analyse(d);
    const std::string text = study::methods_text(f, d, make_analysis_json(a));
    if (o.file.empty())
        fmt::print("{}", text);
    else {
        make_derivatives(o.folder, o.file);
        session::tell_of_pipe_to_write(o.file);
        study::write_report(o.file, text, o.force);
    }
    print_warnings(a);
    return status_ok;
}

} // namespace

command add_report(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("report", "Write the methods section of a study's paper");
    auto o = std::make_shared<report_options>();
    add_study_options(*c, o->folder, o->who);
    add_text(*c, "-o,--output", "FILE.md", "Markdown file to write (default: standard output)",
             [o](const std::string& t) {
                 study::check_report_name(t);
                 o->file = t;
             });
    add_force_option(*c, o->force);
    c->footer("tactor report study\n"
              "tactor report study -o methods.md\n"
              "tactor report study --exclude 07:illness");
    return [o] { return run(*o); };
}

} // namespace tactor::cli
