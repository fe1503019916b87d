// SPDX-License-Identifier: MIT
#include "sink/alsa/handle.hpp"

#include <new>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {
namespace {

// With SND_PCM_NONBLOCK a busy device gives an error at once instead of an endless wait.
constexpr int mode =
    SND_PCM_NONBLOCK | SND_PCM_NO_AUTO_RESAMPLE | SND_PCM_NO_AUTO_CHANNELS | SND_PCM_NO_AUTO_FORMAT;

template <typename T, typename Make>
T* made(Make make)
{
    T* p = nullptr;
    if (make(&p) < 0)
        throw std::bad_alloc();
    return p;
}

surroundings around(snd_config_t* top, const std::string& name, const std::string& messages)
{
    const auto has = [&messages](const std::string& text) { return messages.find(text) != messages.npos; };
    return {.pcms = defined_pcms(top),
            .route = find_route(top, name),
            .bad_arguments = has(fmt::format("Unknown PCM {}\n", name)) && has("Parse arguments error")};
}

} // namespace

hw_params make_hw_params()
{
    return hw_params(made<snd_pcm_hw_params_t>(snd_pcm_hw_params_malloc));
}

hw_params copy(const hw_params& p)
{
    hw_params q = make_hw_params();
    snd_pcm_hw_params_copy(q.get(), p.get());
    return q;
}

sw_params make_sw_params()
{
    return sw_params(made<snd_pcm_sw_params_t>(snd_pcm_sw_params_malloc));
}

status make_status()
{
    return status(made<snd_pcm_status_t>(snd_pcm_status_malloc));
}

handle open(const alsa_options& o, snd_config_t* top)
{
    if (const std::string fault = find_fault(top, o.pcm); !fault.empty())
        throw error(error_kind::not_available, fmt::format("PCM \"{}\"", o.pcm), fault,
                    "mend its definition in /etc/asound.conf or ~/.asoundrc: ALSA's library would end this "
                    "program");
    const library_messages messages;
    snd_pcm_t* p = nullptr;
    int code = snd_pcm_open_lconf(&p, o.pcm.c_str(), SND_PCM_STREAM_PLAYBACK, mode, top);
    if (code < 0)
        tactor::detail::throw_caused(
            open_error(o.pcm, code, messages.first(), around(top, o.pcm, messages.all())), -code);
    handle h(p);
    // Plugins made from other plugins do not always obey the flag of open().
    if (code = snd_pcm_nonblock(h.get(), 1); code < 0)
        tactor::detail::throw_caused(open_error(o.pcm, code, messages.first()), -code);
    return h;
}

} // namespace tactor::alsa
