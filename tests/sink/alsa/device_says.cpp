// SPDX-License-Identifier: MIT
#include "device_says.hpp"

#include <cerrno>

#include <dlfcn.h>

namespace {

const tactor::test::device_answers* answers = nullptr;

template <typename Function>
Function* real(Function*, const char* name)
{
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

} // namespace

tactor::test::device_says::device_says(const device_answers& a)
{
    answers = &a;
}

tactor::test::device_says::~device_says()
{
    answers = nullptr;
}

extern "C" {

int snd_pcm_info_get_card(const snd_pcm_info_t* info)
{
    return answers != nullptr ? answers->card : real(snd_pcm_info_get_card, "snd_pcm_info_get_card")(info);
}

int snd_pcm_hw_params_is_batch(const snd_pcm_hw_params_t* p)
{
    return answers != nullptr ? static_cast<int>(answers->batch)
                              : real(snd_pcm_hw_params_is_batch, "snd_pcm_hw_params_is_batch")(p);
}

int snd_pcm_hw_params_set_periods_near(snd_pcm_t* pcm, snd_pcm_hw_params_t* p, unsigned* n, int* direction)
{
    if (answers != nullptr && !answers->takes_periods)
        return -EINVAL;
    return real(snd_pcm_hw_params_set_periods_near, "snd_pcm_hw_params_set_periods_near")(pcm, p, n,
                                                                                          direction);
}

int snd_pcm_hw_params_get_channels(const snd_pcm_hw_params_t* p, unsigned* n)
{
    const int code = real(snd_pcm_hw_params_get_channels, "snd_pcm_hw_params_get_channels")(p, n);
    if (answers != nullptr)
        *n = answers->channels.value_or(*n);
    return code;
}

int snd_pcm_hw_params_get_rate(const snd_pcm_hw_params_t* p, unsigned* n, int* direction)
{
    const int code = real(snd_pcm_hw_params_get_rate, "snd_pcm_hw_params_get_rate")(p, n, direction);
    if (answers != nullptr)
        *n = answers->rate.value_or(*n);
    return code;
}

int snd_pcm_hw_params_get_period_size(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* n, int* direction)
{
    const int code =
        real(snd_pcm_hw_params_get_period_size, "snd_pcm_hw_params_get_period_size")(p, n, direction);
    if (answers != nullptr)
        *n = answers->period_frames.value_or(*n);
    return code;
}

int snd_pcm_hw_params_get_buffer_size(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* n)
{
    const int code = real(snd_pcm_hw_params_get_buffer_size, "snd_pcm_hw_params_get_buffer_size")(p, n);
    if (answers != nullptr)
        *n = answers->buffer_frames.value_or(*n);
    return code;
}

} // extern "C"
