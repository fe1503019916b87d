// SPDX-License-Identifier: MIT
#include "sink/alsa/handle.hpp"

#include <cerrno>
#include <new>
#include <string>
#include <string_view>

#include <sys/eventfd.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "core/refused.hpp"
#include "core/split.hpp"
#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {
namespace {

// Returns the negative errno if no file can be opened, else 0. Trying one is enough: if libasound has one
// file open and fails to open another, it gives up the whole configuration.
int lack_of_descriptors() noexcept
{
    const detail::owned_fd one(::eventfd(0, EFD_CLOEXEC));
    return one ? 0 : -errno;
}

// Returns the error for files that cannot be read, from libasound's messages: "_toplevel_:LINE:COLUMN:WHY"
// comes first and "FILE may be old or corrupted: ..." after it.
error unreadable(int code, const library_messages& messages)
{
    constexpr std::string_view nameless = "_toplevel_:";
    std::string why = messages.first();
    std::string file;
    const std::string all = messages.all();
    for (const std::string_view line : tactor::detail::split(all, '\n'))
        if (const auto end = line.find(" may be old or corrupted"); end != line.npos && file.empty())
            file = line.substr(0, end);
    if (!file.empty() && why.rfind(nameless, 0) == 0) {
        why.erase(0, nameless.size());
        const auto line = why.find(':');
        const auto column = line == why.npos ? line : why.find(':', line + 1);
        if (column != why.npos) {
            file += ":" + why.substr(0, line);
            why.erase(0, column + 1);
        }
    }
    return {error_kind::not_available, file.empty() ? "ALSA's configuration" : file,
            with_detail("ALSA cannot read its configuration", why.empty() ? snd_strerror(code) : why),
            "mend or remove this file, or one that it includes; ALSA plays nothing until then"};
}

configuration parse(const std::string& text)
{
    const library_messages messages;
    snd_config_t* c = nullptr;
    const int code = snd_config_load_string(&c, text.c_str(), text.size());
    if (code < 0)
        detail::throw_caused(error(error_kind::bad_input, "ALSA configuration text",
                                   with_detail(snd_strerror(code), messages.first()),
                                   "see the ALSA documentation of .asoundrc"),
                             -code);
    return configuration(c);
}

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

configuration read_configuration(const std::string& text)
{
    if (!text.empty())
        return parse(text);
    const library_messages messages;
    snd_config_t* top = nullptr;
    snd_config_update_t* files = nullptr;
    int code = lack_of_descriptors();
    if (code == 0)
        code = snd_config_update_r(&top, &files, nullptr);
    if (files != nullptr)
        snd_config_update_free(files);
    configuration c(top);
    if (code == -EMFILE || code == -ENFILE)
        tactor::detail::refused_by_system("ALSA's configuration", -code, snd_strerror(code));
    if (code < 0)
        detail::throw_caused(unreadable(code, messages), -code);
    return c;
}

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
