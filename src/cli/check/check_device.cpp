// SPDX-License-Identifier: MIT
#include "cli/check/check_device.hpp"

#include <fmt/format.h>

#include "cli/play/play_report.hpp"
#include "cli/play/sound_server.hpp"

namespace tactor::cli {

finding check_device(const alsa_options& device, const play_options& o, bool named)
{
    if (route_of(device.pcm).writes)
        return warning(
            "device",
            fmt::format("{}: not opened, for that would empty its file or start its command", device.pcm),
            "play opens it: is it meant?");
    try {
        const std::string server = settle_server(device.pcm);
        const stream_setup made = open_alsa(device)->setup();
        const std::string found = describe(made) + (server.empty() ? "" : "; " + server_note(server));
        if (!named)
            return warning("device", "none is named, so play goes to " + found,
                           "-D PCM, or pcm under [output]; tactor devices lists them");
        const std::string late = latency_warning(o, made);
        if (!late.empty())
            return warning("device", found + "; " + late, "a device with shorter periods, or more latency");
        if (!server.empty())
            return warning("device", found, server_cure);
        return fine("device", found);
    } catch (const error& e) {
        return failure("device", e);
    }
}

} // namespace tactor::cli
