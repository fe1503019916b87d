// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/abilities.hpp"

#include <algorithm>

#include "sink/alsa/format.hpp"

namespace tactor::pcm {
namespace {

constexpr unsigned usual_rates[] = {8000,  11025, 12000, 16000,  22050,  24000,  32000,  44100,  48000,
                                    64000, 88200, 96000, 176400, 192000, 352800, 384000, 705600, 768000};

// Software PCMs say 1073741823 channels or 4294967295 Hz, and their buffers more still: they do not care.
constexpr snd_pcm_uframes_t beyond = 1U << 29;

unsigned bounded(snd_pcm_uframes_t n)
{
    return n >= beyond ? no_limit : static_cast<unsigned>(n);
}

using unsigned_bound = int (*)(const snd_pcm_hw_params_t*, unsigned*, int*);
using frames_bound = int (*)(const snd_pcm_hw_params_t*, snd_pcm_uframes_t*, int*);

// A bound that is not in the range itself is told by the direction.
count_range range(const hw_params& p, unsigned_bound least, unsigned_bound most)
{
    unsigned low = 0;
    unsigned high = 0;
    int above = 0;
    int below = 0;
    least(p.get(), &low, &above);
    most(p.get(), &high, &below);
    return {low + (above > 0 ? 1U : 0U), bounded(high - (below < 0 && high > 0 ? 1U : 0U))};
}

count_range range(const hw_params& p, frames_bound least, frames_bound most)
{
    snd_pcm_uframes_t low = 0;
    snd_pcm_uframes_t high = 0;
    int above = 0;
    int below = 0;
    least(p.get(), &low, &above);
    most(p.get(), &high, &below);
    return {bounded(low + (above > 0 ? 1U : 0U)), bounded(high - (below < 0 && high > 0 ? 1U : 0U))};
}

int buffer_least(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* v, int*)
{
    return snd_pcm_hw_params_get_buffer_size_min(p, v);
}

int buffer_most(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* v, int*)
{
    return snd_pcm_hw_params_get_buffer_size_max(p, v);
}

// Cards may take 2, 4 and 8 channels and nothing between.
std::vector<count_range> channels(snd_pcm_t* pcm, const hw_params& p)
{
    unsigned least = 0;
    unsigned most = 0;
    snd_pcm_hw_params_get_channels_min(p.get(), &least);
    snd_pcm_hw_params_get_channels_max(p.get(), &most);
    std::vector<count_range> ranges;
    for (unsigned n = std::max(least, 1U); n <= std::min(most, most_channels); ++n) {
        if (snd_pcm_hw_params_test_channels(pcm, p.get(), n) != 0)
            continue;
        if (!ranges.empty() && ranges.back().most + 1 == n)
            ranges.back().most = n;
        else
            ranges.push_back({n, n});
    }
    return ranges;
}

} // namespace

pcm_abilities abilities_of(snd_pcm_t* p, const hw_params& space)
{
    pcm_abilities a;
    a.channels = channels(p, space);
    a.rates_hz = range(space, snd_pcm_hw_params_get_rate_min, snd_pcm_hw_params_get_rate_max);
    for (const unsigned hz : usual_rates)
        if (snd_pcm_hw_params_test_rate(p, space.get(), hz, 0) == 0)
            a.usual_rates_hz.push_back(hz);
    for (const format_kind f : format_preference)
        if (snd_pcm_hw_params_test_format(p, space.get(), to_alsa(f)) == 0)
            a.formats.push_back(f);
    a.period_frames =
        range(space, snd_pcm_hw_params_get_period_size_min, snd_pcm_hw_params_get_period_size_max);
    a.periods = range(space, snd_pcm_hw_params_get_periods_min, snd_pcm_hw_params_get_periods_max);
    a.buffer_frames = range(space, buffer_least, buffer_most);
    return a;
}

} // namespace tactor::pcm
