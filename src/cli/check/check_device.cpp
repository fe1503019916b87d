// SPDX-License-Identifier: MIT
#include "cli/check/check_device.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/play/play_report.hpp"
#include "session/device.hpp"
#include "session/sound_server.hpp"

namespace tactor::cli {

namespace {

finding told_lost(const alsa_options& device, const std::string& lost)
{
    return failure("device",
                   {error_kind::not_available, fmt::format("PCM \"{}\"", device.pcm), lost,
                    "give each channel one of the device's, at 1, where the PCM is defined (ttable, "
                    "bindings), or play on the card itself: -D hw:CARD=NAME"});
}

finding told_open(const alsa_options& device, const session::stream_options& o, const environment& e,
                  bool named)
{
    const std::string server = session::settle_server(device.pcm);
    const stream_setup made = session::open_device(device)->setup();
    if (const std::string lost = lost_tactor(e.tactors, made.wiring); !lost.empty())
        return told_lost(device, lost);
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
    std::string told = found;
    for (const session::device_note& n : notes)
        told += "; " + n.text;
    if (!notes.empty())
        return warning("device", told, notes.front().cure);
    return fine("device", found);
}

} // namespace

finding check_device(const alsa_options& device, const session::stream_options& o, const environment& e,
                     bool named)
{
    if (route_of(device.pcm).writes) {
        const std::string lost = lost_tactor(e.tactors, wiring_of(device.pcm, device.channels));
        return lost.empty()
                   ? warning("device",
                             fmt::format("{}: not opened, for that would empty its file or start its command",
                                         device.pcm),
                             "play opens it: is it meant?")
                   : told_lost(device, lost);
    }
    try {
        return told_open(device, o, e, named);
    } catch (const error& failed) {
        return failure("device", failed);
    }
}

} // namespace tactor::cli
