// SPDX-License-Identifier: MIT
#include "sink/alsa/ranges.hpp"

#include <memory>
#include <new>

#include <fmt/format.h>

#include "sink/alsa/format.hpp"

namespace tactor::pcm {
namespace {

// Software PCMs say 1073741823 channels or 4294967295 Hz, which means that they do not care.
std::string range(unsigned least, unsigned most, unsigned beyond)
{
    if (least == most)
        return fmt::format("{}", least);
    if (most >= beyond)
        return least <= 1 ? "any" : fmt::format("{} or more", least);
    return fmt::format("{} to {}", least, most);
}

std::string formats(const hw_params& p)
{
    snd_pcm_format_mask_t* raw = nullptr;
    if (snd_pcm_format_mask_malloc(&raw) < 0)
        throw std::bad_alloc();
    const std::unique_ptr<snd_pcm_format_mask_t, deleter<snd_pcm_format_mask_free>> mask(raw);
    snd_pcm_hw_params_get_format_mask(p.get(), mask.get());
    std::string names;
    for (const format_kind f : format_preference)
        if (snd_pcm_format_mask_test(mask.get(), to_alsa(f)) != 0)
            names += fmt::format(" {}", to_string(f));
    return names.empty() ? " none that tactor plays" : names;
}

} // namespace

std::string describe(const hw_params& p)
{
    unsigned first_channels = 0;
    unsigned last_channels = 0;
    snd_pcm_hw_params_get_channels_min(p.get(), &first_channels);
    snd_pcm_hw_params_get_channels_max(p.get(), &last_channels);
    unsigned least_rate = 0;
    unsigned most_rate = 0;
    int direction = 0;
    snd_pcm_hw_params_get_rate_min(p.get(), &least_rate, &direction);
    snd_pcm_hw_params_get_rate_max(p.get(), &most_rate, &direction);
    if (direction < 0)
        --most_rate; // the bound itself is not in the range
    return fmt::format("channels {}, rates {} Hz, formats{}", range(first_channels, last_channels, 10000),
                       range(least_rate, most_rate, 10'000'000), formats(p));
}

} // namespace tactor::pcm
