// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/devices/devices_output.hpp"
#include "cli/input.hpp"
#include "cli/play/open_device.hpp"
#include "cli/play/play_options.hpp"

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

} // namespace tactor::cli
