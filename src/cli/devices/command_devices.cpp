// SPDX-License-Identifier: MIT
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/devices/devices_output.hpp"
#include "cli/input.hpp"
#include "cli/play/open_device.hpp"
#include "cli/play/play_options.hpp"
#include "cli/say.hpp"

namespace tactor::cli {
namespace {

// Adds what only the array can tell: a tactor that does not reach the device, or a smaller array that fits.
void look_behind(const array& a, alsa_options wanted, pcm_info& p)
{
    if (!p.opened)
        return;
    if (p.misfit.empty()) {
        p.misfit = lost_tactor(a, wiring_of(p.name, wanted.channels));
        return;
    }
    wanted.pcm = p.name;
    if (const std::string smaller = find_array_that_fits(wanted); !smaller.empty())
        p.misfit += fmt::format("; the array {} fits", smaller);
}

int list_devices(settings& s, option_list& options, bool as_json)
{
    const device_list d = look_for_devices(s, read_environment(s, options));
    if (as_json)
        fmt::print("{}", devices_json(d));
    else
        say_text(stdout, devices_text(d));
    return status_ok;
}

} // namespace

device_list look_for_devices(const settings& s, const environment& e)
{
    const render_options render = settle_render(s, e);
    device_list d;
    d.array_name = e.tactors.name;
    d.pcm_is_configured = names_device(s, e);
    d.wanted = device_options(s, {}, e, render.channels, render.rate);
    d.pcms = list_pcms(d.wanted);
    for (pcm_info& p : d.pcms)
        look_behind(e.tactors, d.wanted, p);
    d.chips = list_gpio();
    return d;
}

command add_devices(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("devices", "List PCMs, what they can do, and GPIO lines");
    auto s = std::make_shared<settings>();
    auto options = std::make_shared<option_list>(*c, *s);
    auto format = std::make_shared<std::string>();
    options->add_array_options();
    options->add_device_options();
    options->add_rate_options();
    add_format_option(*c, *format, {"text", "json"}, "how to print it (default text)");
    c->footer("Example: tactor devices --array palm-2x4");
    return [s, options, format] { return list_devices(*s, *options, *format == "json"); };
}

} // namespace tactor::cli
