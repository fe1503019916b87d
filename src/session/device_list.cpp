// SPDX-License-Identifier: MIT
#include "session/device_list.hpp"

#include <optional>

#include <nlohmann/json.hpp>

#include "core/members.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "session/device.hpp"

namespace tactor::session {
namespace {

using detail::about;
using detail::omit_empty;
using detail::omit_usual;

constexpr about both_ends{"both ends"};

template <class Io>
void range_members(Io& io, const count_range& r, const about& ends)
{
    io("min", r.least, ends);
    io.or_null("max", omit_usual(r.most, no_limit), ends);
}

template <class Io>
void ability_members(Io& io, const pcm_abilities& a)
{
    const auto range = [&io](const char* name, const count_range& r, const about& what, const about& ends) {
        io.object(name, what, [&](auto& inner) { range_members(inner, r, ends); });
    };
    io.list("channels", a.channels, {"numbers of channels, as ranges"},
            [](auto& inner, const count_range& r, std::size_t) {
                range_members(inner, r, {"both ends; 1024 is the most that is looked for"});
            });
    range("rate_hz", a.rates_hz, {"sample rates"}, {"both ends; a max of null is no limit, here and below"});
    io("usual_rates_hz", a.usual_rates_hz, {"those of the usual ones that it takes"});
    io("formats", a.formats, {"as in tactor-play/1"});
    range("period_frames", a.period_frames, {"frames in a period"}, both_ends);
    range("periods", a.periods, {"periods in the buffer"}, both_ends);
    range("buffer_frames", a.buffer_frames, {"frames in the buffer"}, both_ends);
}

template <class Io>
void pcm_members(Io& io, const pcm_info& p, bool is_configured)
{
    io("name", p.name, {"for -D"});
    io.or_null("description", omit_empty(p.description),
               {"what the driver or the ALSA configuration calls it; else null"});
    io("hardware", p.hardware, {"whether it is a card's own"});
    io("configured", p.wanted && is_configured, {"whether -D or the configuration names it"});
    io("tried", p.tried, {"whether it was opened, or an attempt was made"});
    io("opened", p.opened, {"whether that succeeded"});
    io.or_null("error", omit_empty(p.error), {"why not; else null"});
    io.list("holders", p.holders, {"processes that have it open"},
            [](auto& inner, const process_info& h, std::size_t) {
                constexpr about process{"process, and name of its program or null"};
                inner("pid", h.pid, process);
                inner.or_null("program", omit_empty(h.program), process);
            });
    io.object_or_null("can", p.can, {"what it takes, each alone; null where it was not opened"},
                      [](auto& inner, const pcm_abilities& a) { ability_members(inner, a); });
    io.or_null("fits", p.can ? std::optional(p.misfit.empty()) : std::nullopt,
               {"whether it takes what is wanted, and each tactor has a channel of the device to itself; "
                "null where it was not opened"});
    io.or_null("misfit", omit_empty(p.misfit),
               {"what it does not take, or which tactor would be lost; else null"});
}

template <class Io>
void chip_members(Io& io, const gpio_chip_info& c)
{
    io("path", c.path, {"device file"});
    io.or_null("label", omit_empty(c.label),
               {"name of the chip, as lines in tactor.toml(5) have it; null where it could not be opened"});
    io.or_null("error", omit_empty(c.error), {"why not; else null"});
    io.list("lines", c.lines, {"its lines"}, [](auto& inner, const gpio_line_info& l, std::size_t) {
        inner("offset", l.offset, {"number of the line"});
        inner.or_null("name", omit_empty(l.name), {"its name or null"});
        inner.one_of("direction", l.output ? "output" : "input", {"input", "output"}, {"input or output"});
        inner.or_null("consumer", omit_empty(l.consumer), {"who holds it, or null"});
    });
}

template <class Io>
void list_members(Io& io, const device_list& d)
{
    io.constant("schema", "tactor-devices/1");
    io.object("wanted", {"what the array needs"}, [&d](auto& inner) {
        inner("array", d.array_name, {"its name"});
        inner("channels", d.wanted.channels, {"channels and sample rate"});
        inner("rate_hz", d.wanted.rate, {"channels and sample rate"});
        inner.or_null("format", d.wanted.format, {"what --sample-format says; null: any"});
    });
    io.list(
        "pcms", d.pcms, {"playback devices, cards first"},
        [&d](auto& inner, const pcm_info& p, std::size_t) { pcm_members(inner, p, d.pcm_is_configured); });
    io.list("gpio_chips", d.chips, {"GPIO chips"},
            [](auto& inner, const gpio_chip_info& c, std::size_t) { chip_members(inner, c); });
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
    return files::make_object([&d](auto& io) { list_members(io, d); }).dump(2) + "\n";
}

nlohmann::ordered_json devices_schema()
{
    return files::json_schema::describe_object([](auto& io) { list_members(io, device_list{}); });
}

} // namespace tactor::session
