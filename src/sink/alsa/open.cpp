// SPDX-License-Identifier: MIT
#include <tactor/alsa.hpp>

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/log.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"
#include "sink/alsa/adopt.hpp"
#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/library_messages.hpp"
#include "sink/alsa/negotiate.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace tactor::alsa {
namespace {

bool is_on_card(snd_pcm_t* p)
{
    snd_pcm_info_t* info = nullptr;
    snd_pcm_info_alloca(&info);
    return snd_pcm_info(p, info) == 0 && snd_pcm_info_get_card(info) >= 0;
}

// Configures a PCM. `top`: the configuration that defines it; null: none does.
std::unique_ptr<sink> configure(handle h, const alsa_options& o, snd_config_t* top, bool as_card,
                                std::string_view device)
try {
    const library_messages silent;
    stream_setup s = negotiate(h.get(), o);
    s.device = device;
    if (top != nullptr)
        s.wiring = find_wiring(top, o.pcm, o.channels, s.device_channels);
    set_software(h.get(), s);
    detail::log(o.log, log_kind::info, "PCM \"{}\": {}, {} Hz, {}, {} of {} frames{}", o.pcm,
                s.device_channels == s.channels
                    ? counted(s.channels, "channel")
                    : fmt::format("{} of {} channels", s.channels, s.device_channels),
                s.rate, to_string(s.format), s.buffer_frames / s.period_frames, s.period_frames,
                s.period_frames == o.period_frames && s.buffer_frames == o.periods * s.period_frames
                    ? ""
                    : fmt::format("; {} of {} were wished", o.periods, o.period_frames));
    if (s.batch)
        detail::log(o.log, log_kind::debug, "PCM \"{}\": its position moves by whole periods", o.pcm);
    if (!s.wiring.hidden_by.empty())
        detail::log(o.log, log_kind::warning,
                    "PCM \"{}\": which of the device's channels its own reach is not known: {} is between",
                    o.pcm, s.wiring.hidden_by);
    const bool on_card = as_card || is_on_card(h.get());
    return std::make_unique<pcm_sink>(std::move(h), std::move(s), on_card);
} catch (const error&) {
    throw;
} catch (const std::system_error& e) {
    detail::refused_by_system(fmt::format("PCM \"{}\"", o.pcm), e.code().value(), e.what());
}

} // namespace

std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card, std::string_view device)
{
    handle h(p);
    check(o);
    return configure(std::move(h), o, nullptr, as_card, device);
}

} // namespace tactor::alsa

namespace tactor {
inline namespace v0 {

std::unique_ptr<sink> open_alsa(const alsa_options& o)
{
    alsa::check(o);
    const alsa::configuration top = alsa::read_configuration(o.config_text);
    return alsa::configure(alsa::open(o, top.get()), o, top.get(), false, o.pcm);
}

std::unique_ptr<sink> reopen_alsa(const alsa_options& o, const std::function<bool(double)>& pause)
{
    constexpr double longest_s = 5.0;
    if (!pause)
        throw error(error_kind::bad_input, "reopen_alsa", "there is nothing that waits", "give a function");
    detail::log(o.log, log_kind::info, "waiting for PCM \"{}\" to come back", o.pcm);
    for (double wait_s = 0.1; pause(wait_s); wait_s = std::min(2.0 * wait_s, longest_s)) {
        try {
            std::unique_ptr<sink> s = open_alsa(o);
            detail::log(o.log, log_kind::info, "PCM \"{}\" is back", o.pcm);
            return s;
        } catch (const error& e) {
            // The device is not back yet, or udev has not set its group yet.
            if (e.kind() != error_kind::not_available)
                throw;
            detail::log(o.log, log_kind::debug, "not back yet: {}", e.what());
        }
    }
    return nullptr;
}

} // namespace v0
} // namespace tactor
