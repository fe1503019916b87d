// SPDX-License-Identifier: MIT
#include "cli/check/finding.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/play/play_report.hpp"
#include "session/device.hpp"

namespace tactor::cli {

namespace {

finding refuse_lost_tactor(const alsa_options& device, const std::string& lost)
{
    return failure("device", {error_kind::not_available, fmt::format("PCM \"{}\"", device.pcm), lost,
                              "give each channel one of the device's, at 1, where the PCM is defined "
                              "(ttable, bindings), or play on the card itself: -D hw:CARD=NAME"});
}

std::string note_text(const std::vector<session::device_note>& notes)
{
    std::string text;
    for (const session::device_note& n : notes)
        text += "; " + n.text;
    return text;
}

finding check_open(const alsa_options& device, const session::stream_options& o, const environment& e,
                   bool named)
{
    const std::string server = session::settle_server(device.pcm);
    const stream_setup made = session::open_device(device, e.tactors)->setup();
    if (const std::string lost = lost_tactor(e.tactors, made.wiring); !lost.empty())
        return refuse_lost_tactor(device, lost);
    const std::string found = describe(made) + (server.empty() ? "" : "; " + session::server_note(server));
    if (!named)
        return warning("device", "none is named, so play goes to " + found,
                       "-D PCM, or pcm under [output]; tactor devices lists them");
    const std::string late = session::latency_warning(o.latency_ms, made);
    if (!late.empty())
        return warning("device", found + "; " + late, "a device with shorter periods, or more latency");
    if (!server.empty())
        return warning("device", found, session::server_cure);
    const std::vector<session::device_note> notes = session::wiring_notes(e.tactors, made);
    if (!notes.empty())
        return warning("device", found + note_text(notes), notes.front().cure);
    return fine("device", found);
}

std::string line_words(const gpio_line_place& p)
{
    return fmt::format("line {}{} of {} ({})", p.line.offset,
                       p.line.name.empty() ? "" : fmt::format(" \"{}\"", p.line.name), p.label, p.path);
}

finding check_line(const char* check, const gpio_line_name& name, line_finder find)
{
    try {
        const gpio_line_place p = find(name);
        if (p.line.consumer.empty())
            return fine(check, line_words(p) + ", free");
        const bool own = p.line.consumer == "tactor";
        return {check, level::error, fmt::format("{}: held by \"{}\"", line_words(p), p.line.consumer),
                own ? "another tactor runs: stop it" : "stop that program, or choose another line",
                error_kind::not_available};
    } catch (const error& e) {
        return failure(check, e);
    }
}

} // namespace

finding check_device(const alsa_options& device, const session::stream_options& o, const environment& e,
                     bool named)
{
    if (read_route(device.pcm).writes) {
        const stream_setup there{.name = device.pcm, .wiring = read_wiring(device.pcm, device.channels)};
        if (const std::string lost = lost_tactor(e.tactors, there.wiring); !lost.empty())
            return refuse_lost_tactor(device, lost);
        return warning(
            "device",
            fmt::format("{}: not opened, for that would empty its file or start its command", device.pcm) +
                note_text(session::wiring_notes(e.tactors, there)),
            "play opens it: is it meant?");
    }
    try {
        return check_open(device, o, e, named);
    } catch (const error& failed) {
        return failure("device", failed);
    }
}

std::vector<finding> check_lines(const setup& config, bool felt, line_finder find)
{
    std::vector<finding> all;
    if (!config.amplifier)
        all.push_back({"amplifier", felt ? level::warning : level::ok,
                       "no [amplifier]: nothing switches it off",
                       "wire its enable input to a GPIO line, see tactor-raspberry-pi(7)"});
    else {
        finding f = check_line("amplifier", config.amplifier->line, find);
        if (f.how == level::ok && config.amplifier->active_low)
            f = warning("amplifier", f.found + ", on when low: a line that floats may switch it on",
                        "use an amplifier that is on when high, with a pull-down resistor");
        all.push_back(std::move(f));
    }
    if (config.sync && config.sync->out)
        all.push_back(check_line("sync out", *config.sync->out, find));
    if (config.sync && config.sync->in)
        all.push_back(check_line("sync in", *config.sync->in, find));
    return all;
}

} // namespace tactor::cli
