// SPDX-License-Identifier: MIT
#include "alsa/handle.hpp"

#include <new>
#include <string>
#include <vector>

#include "alsa/error_text.hpp"
#include "alsa/library_messages.hpp"

namespace tactor::pcm {
namespace {

// Non-blocking makes a busy device an error at once instead of a wait without end.
constexpr int mode =
    SND_PCM_NONBLOCK | SND_PCM_NO_AUTO_RESAMPLE | SND_PCM_NO_AUTO_CHANNELS | SND_PCM_NO_AUTO_FORMAT;

using configuration = std::unique_ptr<snd_config_t, deleter<snd_config_delete>>;

template <typename T, typename Make>
T* made(Make make)
{
    T* p = nullptr;
    if (make(&p) < 0)
        throw std::bad_alloc();
    return p;
}

configuration parse(const std::string& text, const library_messages& said)
{
    snd_config_t* c = nullptr;
    const int code = snd_config_load_string(&c, text.c_str(), text.size());
    if (code < 0)
        throw error(errc::bad_input, "ALSA configuration text", with_detail(snd_strerror(code), said.first()),
                    "see the ALSA documentation of .asoundrc");
    return configuration(c);
}

// The PCMs that a configuration defines, for those who mistyped one.
std::vector<std::string> pcm_names(snd_config_t* top)
{
    std::vector<std::string> names;
    snd_config_t* pcms = nullptr;
    if (top == nullptr || snd_config_search(top, "pcm", &pcms) < 0 ||
        snd_config_get_type(pcms) != SND_CONFIG_TYPE_COMPOUND)
        return names;
    snd_config_iterator_t i = snd_config_iterator_first(pcms);
    for (; i != snd_config_iterator_end(pcms); i = snd_config_iterator_next(i)) {
        const char* id = nullptr;
        if (snd_config_get_id(snd_config_iterator_entry(i), &id) == 0 && id != nullptr)
            names.emplace_back(id);
    }
    return names;
}

std::vector<std::string> system_pcm_names()
{
    snd_config_t* top = nullptr;
    if (snd_config_update_ref(&top) < 0)
        return {};
    std::vector<std::string> names = pcm_names(top);
    snd_config_unref(top);
    return names;
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

handle open(const alsa_options& o)
{
    const library_messages said;
    snd_pcm_t* p = nullptr;
    int code = 0;
    surroundings there;
    if (o.config_text.empty()) {
        code = snd_pcm_open(&p, o.pcm.c_str(), SND_PCM_STREAM_PLAYBACK, mode);
        if (code < 0)
            there.pcms = system_pcm_names();
    } else {
        const configuration c = parse(o.config_text, said);
        code = snd_pcm_open_lconf(&p, o.pcm.c_str(), SND_PCM_STREAM_PLAYBACK, mode, c.get());
        if (code < 0)
            there.pcms = pcm_names(c.get());
    }
    if (code < 0)
        throw open_error(o.pcm, code, said.first(), there);
    handle h(p);
    // Plugins made from other plugins do not always take the flag of open().
    if (code = snd_pcm_nonblock(h.get(), 1); code < 0)
        throw open_error(o.pcm, code, said.first());
    return h;
}

} // namespace tactor::pcm
