// SPDX-License-Identifier: MIT
// Captures a PCM and times each sound: one line "onset FRAME NANOSECONDS" on standard output for each sound
// after at least 0.1 s of silence, CLOCK_MONOTONIC of its first sample at the device.
//   capture PCM CHANNELS FILE.raw       S32 at 48 kHz; ends on SIGTERM or SIGINT, or when the card goes
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <alsa/asoundlib.h>

namespace {

constexpr unsigned rate = 48000;
constexpr snd_pcm_uframes_t period = 240;
constexpr std::uint64_t quiet = rate / 10;

volatile std::sig_atomic_t stop = 0;

snd_pcm_t* open_capture(const char* name, unsigned channels)
{
    snd_pcm_t* pcm = nullptr;
    if (snd_pcm_open(&pcm, name, SND_PCM_STREAM_CAPTURE, 0) < 0)
        return nullptr;
    snd_pcm_hw_params_t* hw = nullptr;
    snd_pcm_hw_params_alloca(&hw);
    snd_pcm_hw_params_any(pcm, hw);
    snd_pcm_uframes_t size = period;
    snd_pcm_uframes_t buffer = period * 64;
    int dir = 0;
    const bool done = snd_pcm_hw_params_set_access(pcm, hw, SND_PCM_ACCESS_RW_INTERLEAVED) == 0 &&
                      snd_pcm_hw_params_set_format(pcm, hw, SND_PCM_FORMAT_S32_LE) == 0 &&
                      snd_pcm_hw_params_set_channels(pcm, hw, channels) == 0 &&
                      snd_pcm_hw_params_set_rate(pcm, hw, rate, 0) == 0 &&
                      snd_pcm_hw_params_set_period_size_near(pcm, hw, &size, &dir) == 0 &&
                      snd_pcm_hw_params_set_buffer_size_near(pcm, hw, &buffer) == 0 &&
                      snd_pcm_hw_params(pcm, hw) == 0;
    snd_pcm_sw_params_t* sw = nullptr;
    snd_pcm_sw_params_alloca(&sw);
    if (!done || snd_pcm_sw_params_current(pcm, sw) < 0 ||
        snd_pcm_sw_params_set_tstamp_mode(pcm, sw, SND_PCM_TSTAMP_ENABLE) < 0 ||
        snd_pcm_sw_params_set_tstamp_type(pcm, sw, SND_PCM_TSTAMP_TYPE_MONOTONIC) < 0 ||
        snd_pcm_sw_params(pcm, sw) < 0) {
        snd_pcm_close(pcm);
        return nullptr;
    }
    return pcm;
}

// Returns the time of frame `frame` of the stream at the device; `read`: frames read so far.
long long frame_time(snd_pcm_t* pcm, std::uint64_t frame, std::uint64_t read)
{
    snd_pcm_status_t* status = nullptr;
    snd_pcm_status_alloca(&status);
    if (snd_pcm_status(pcm, status) < 0)
        return 0;
    snd_htimestamp_t t;
    snd_pcm_status_get_htstamp(status, &t);
    const auto now = static_cast<long long>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
    const auto since = static_cast<long long>(read + snd_pcm_status_get_avail(status) - frame);
    return now - since * 1'000'000'000 / rate;
}

} // namespace

int main(int argc, char** argv)
{
    if (argc != 4)
        return 2;
    const auto channels = static_cast<unsigned>(std::strtoul(argv[2], nullptr, 10));
    snd_pcm_t* pcm = open_capture(argv[1], channels);
    std::FILE* out = std::fopen(argv[3], "wb");
    if (pcm == nullptr || out == nullptr) {
        std::fprintf(stderr, "capture: %s cannot be opened\n", argv[1]);
        return 3;
    }
    for (int s : {SIGTERM, SIGINT})
        std::signal(s, [](int) { stop = 1; });
    std::puts("ready");
    std::fflush(stdout);

    std::vector<std::int32_t> block(period * channels);
    std::uint64_t read = 0;
    std::uint64_t silent = quiet;
    while (stop == 0) {
        const snd_pcm_sframes_t n = snd_pcm_readi(pcm, block.data(), period);
        if (n == -EPIPE) {
            std::puts("overrun");
            snd_pcm_prepare(pcm);
            continue;
        }
        if (n < 0)
            break;
        const auto frames = static_cast<std::uint64_t>(n);
        std::fwrite(block.data(), channels * sizeof(std::int32_t), frames, out);
        for (std::uint64_t f = 0; f < frames; ++f) {
            bool sound = false;
            for (unsigned c = 0; c < channels; ++c)
                sound = sound || block[f * channels + c] != 0;
            if (sound && silent >= quiet) {
                std::printf("onset %llu %lld\n", static_cast<unsigned long long>(read + f),
                            frame_time(pcm, read + f, read + frames));
                std::fflush(stdout);
            }
            silent = sound ? 0 : silent + 1;
        }
        read += frames;
    }
    std::fclose(out);
    snd_pcm_close(pcm);
    return 0;
}
