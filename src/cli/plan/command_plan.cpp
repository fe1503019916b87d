// SPDX-License-Identifier: MIT
#include <cerrno>
#include <cstdio>
#include <memory>
#include <span>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/input.hpp"
#include "cli/plan/plan_output.hpp"
#include "cli/warnings.hpp"
#include "files/plan/plan_json.hpp"
#include "session/threshold_carrier.hpp"

namespace tactor::cli {
namespace {

// A plan of an hour ends where its reader does.
void write_part(std::string_view part)
{
    if (std::fwrite(part.data(), 1, part.size(), stdout) != part.size())
        throw std::system_error(errno, std::generic_category(), "cannot write a plan");
}

int print_plan(settings& s, const std::string& format)
{
    const environment e = session::read_environment(s);
    const piece p = plan_one_piece(s, e);
    const render_options sound = session::settle_render(s, e);
    const score samples = make_score(p, e, sound); // levels and carrier are checked when planned
    session::tell_of_other_carrier(e, sound, std::span(&samples, 1));
    if (format == "json")
        files::write_plans(record_plans(p, e, samples, sound), write_part);
    else if (format == "csv") {
        say_warnings(collect_warnings(p.plans)); // there is no place for them in a table
        print_csv(stdout, p, e);
    } else
        print_text(stdout, p, e, sound);
    return status_ok;
}

} // namespace

command add_plan(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("plan", "Print the schedule: who plays when, how strongly");
    auto s = std::make_shared<settings>();
    auto format = std::make_shared<std::string>("text");
    add_strokes(*c, *s);
    add_options(*c, *s, options::on_plan);
    add_format_option(*c, *format, {"text", "json", "csv"}, "how to print it (default text)");
    c->footer("Example: tactor plan park2016-1 --format json");
    return [s, format] { return run_with(*s, [&] { return print_plan(*s, *format); }); };
}

} // namespace tactor::cli
