// SPDX-License-Identifier: MIT
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/devices/devices_text.hpp"
#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {
namespace {

int list_devices(settings& s, bool as_json)
{
    const session::device_list d = session::look_for_devices(s, session::read_environment(s));
    if (as_json)
        fmt::print("{}", session::devices_json(d));
    else
        say_text(stdout, devices_text(d));
    return status_ok;
}

} // namespace

command add_devices(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("devices", "List PCMs, what they can do, and GPIO lines");
    auto s = std::make_shared<settings>();
    auto format = std::make_shared<std::string>();
    add_options(*c, *s, options::on_devices);
    add_format_option(*c, *format, {"text", "json"}, "how to print it (default text)");
    c->footer("Example: tactor devices --array palm-2x4");
    return [s, format] { return run_with(*s, [&] { return list_devices(*s, *format == "json"); }); };
}

} // namespace tactor::cli
