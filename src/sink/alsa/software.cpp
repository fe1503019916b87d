// SPDX-License-Identifier: MIT
#include "core/refused.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/negotiate.hpp"

namespace tactor::pcm {

void set_software(snd_pcm_t* p, const stream_setup& s)
{
    const sw_params w = make_sw_params();
    const auto must = [&s](int code, const char* call) {
        if (code < 0)
            tactor::detail::throw_caused(call_error(s.name, call, code), -code);
    };
    must(snd_pcm_sw_params_current(p, w.get()), "snd_pcm_sw_params_current");
    snd_pcm_uframes_t boundary = 0;
    must(snd_pcm_sw_params_get_boundary(w.get(), &boundary), "snd_pcm_sw_params_get_boundary");

    // Only snd_pcm_start() starts: the instant is known, and the amplifier can follow it.
    must(snd_pcm_sw_params_set_start_threshold(p, w.get(), boundary),
         "snd_pcm_sw_params_set_start_threshold");
    // An underrun stops the DAC. A threshold beyond the buffer would replay old frames for ever.
    must(snd_pcm_sw_params_set_stop_threshold(p, w.get(), s.buffer_frames),
         "snd_pcm_sw_params_set_stop_threshold");
    must(snd_pcm_sw_params_set_avail_min(p, w.get(), s.period_frames), "snd_pcm_sw_params_set_avail_min");
    must(snd_pcm_sw_params_set_tstamp_mode(p, w.get(), SND_PCM_TSTAMP_ENABLE),
         "snd_pcm_sw_params_set_tstamp_mode");
    must(snd_pcm_sw_params_set_tstamp_type(p, w.get(), SND_PCM_TSTAMP_TYPE_MONOTONIC),
         "snd_pcm_sw_params_set_tstamp_type");
    // What has been played is overwritten by silence, for a device that runs on past the last frame.
    must(snd_pcm_sw_params_set_silence_threshold(p, w.get(), 0), "snd_pcm_sw_params_set_silence_threshold");
    must(snd_pcm_sw_params_set_silence_size(p, w.get(), boundary), "snd_pcm_sw_params_set_silence_size");
    must(snd_pcm_sw_params(p, w.get()), "snd_pcm_sw_params");
}

} // namespace tactor::pcm
