// SPDX-License-Identifier: MIT
#include "session/device_list.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/plan/json_value.hpp"
#include "session/device.hpp"

namespace tactor::session {
namespace {

using files::or_null;
using json = nlohmann::ordered_json;

json to_json(const count_range& r)
{
    return {{"min", r.least}, {"max", r.most == no_limit ? json(nullptr) : json(r.most)}};
}

json to_json(const pcm_abilities& a)
{
    json channels = json::array();
    for (const count_range& r : a.channels)
        channels.push_back(to_json(r));
    json formats = json::array();
    for (const format_kind f : a.formats)
        formats.push_back(std::string(to_string(f)));
    return {{"channels", channels},
            {"rate_hz", to_json(a.rates_hz)},
            {"usual_rates_hz", a.usual_rates_hz},
            {"formats", formats},
            {"period_frames", to_json(a.period_frames)},
            {"periods", to_json(a.periods)},
            {"buffer_frames", to_json(a.buffer_frames)}};
}

json to_json(const pcm_info& p, bool configured)
{
    json holders = json::array();
    for (const process_info& h : p.holders)
        holders.push_back({{"pid", h.pid}, {"program", or_null(h.program)}});
    return {{"name", p.name},
            {"description", or_null(p.description)},
            {"hardware", p.hardware},
            {"configured", p.wanted && configured},
            {"tried", p.tried},
            {"opened", p.opened},
            {"error", or_null(p.error)},
            {"holders", holders},
            {"can", p.can ? to_json(*p.can) : json(nullptr)},
            {"fits", p.can ? json(p.misfit.empty()) : json(nullptr)},
            {"misfit", or_null(p.misfit)}};
}

json to_json(const gpio_chip_info& c)
{
    json lines = json::array();
    for (const gpio_line_info& l : c.lines)
        lines.push_back({{"offset", l.offset},
                         {"name", or_null(l.name)},
                         {"direction", l.output ? "output" : "input"},
                         {"consumer", or_null(l.consumer)}});
    return {{"path", c.path}, {"label", or_null(c.label)}, {"error", or_null(c.error)}, {"lines", lines}};
}

// Adds what only the array can tell: a tactor that does not reach the device, or a smaller array that fits.
void look_behind(const array& a, alsa_options wanted, pcm_info& p)
{
    if (!p.opened)
        return;
    if (p.misfit.empty()) {
        p.misfit = lost_tactor(a, read_wiring(p.name, wanted.channels));
        return;
    }
    wanted.pcm = p.name;
    if (const std::string fit = find_fit(wanted, a); !fit.empty())
        p.misfit += "; " + fit;
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

std::string devices_json(const device_list& d)
{
    json pcms = json::array();
    for (const pcm_info& p : d.pcms)
        pcms.push_back(to_json(p, d.pcm_is_configured));
    json chips = json::array();
    for (const gpio_chip_info& c : d.chips)
        chips.push_back(to_json(c));
    const json format = d.wanted.format ? json(std::string(to_string(*d.wanted.format))) : json(nullptr);
    const json all{{"schema", "tactor-devices/1"},
                   {"wanted",
                    {{"array", d.array_name},
                     {"channels", d.wanted.channels},
                     {"rate_hz", d.wanted.rate},
                     {"format", format}}},
                   {"pcms", pcms},
                   {"gpio_chips", chips}};
    return all.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

} // namespace tactor::session
