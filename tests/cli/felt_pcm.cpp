// SPDX-License-Identifier: MIT
// A PCM "felt" without a card: it takes frames by CLOCK_MONOTONIC and drops them. Unlike ALSA's null device
// it may, for all that its configuration says, be felt.
#include <cstdint>
#include <cstdlib>
#include <ctime>

#include <alsa/asoundlib.h>
#include <alsa/pcm_external.h>
#include <sys/timerfd.h>
#include <unistd.h>

namespace {

struct felt {
    snd_pcm_ioplug_t io = {};
    int timer = -1;
    std::int64_t began_ns = 0; ///< 0: it does not run
};

std::int64_t now_ns()
{
    timespec t = {};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

felt& self(snd_pcm_ioplug_t* io)
{
    return *static_cast<felt*>(io->private_data);
}

int start(snd_pcm_ioplug_t* io)
{
    self(io).began_ns = now_ns();
    const itimerspec each_ms = {.it_interval = {0, 1'000'000}, .it_value = {0, 1'000'000}};
    return ::timerfd_settime(self(io).timer, 0, &each_ms, nullptr);
}

int stop(snd_pcm_ioplug_t* io)
{
    self(io).began_ns = 0;
    return 0;
}

snd_pcm_sframes_t pointer(snd_pcm_ioplug_t* io)
{
    const auto written = static_cast<std::int64_t>(io->appl_ptr);
    if (self(io).began_ns == 0 || written == 0)
        return 0;
    // It waits for a writer that is late, as a device without a DAC can.
    const std::int64_t due =
        (now_ns() - self(io).began_ns) * static_cast<std::int64_t>(io->rate) / 1'000'000'000;
    const std::int64_t played = due < written ? due : written - 1;
    return static_cast<snd_pcm_sframes_t>(played % static_cast<std::int64_t>(io->buffer_size));
}

snd_pcm_sframes_t transfer(snd_pcm_ioplug_t*, const snd_pcm_channel_area_t*, snd_pcm_uframes_t,
                           snd_pcm_uframes_t size)
{
    return static_cast<snd_pcm_sframes_t>(size);
}

int revents(snd_pcm_ioplug_t*, pollfd* fds, unsigned, unsigned short* events)
{
    std::uint64_t expired = 0;
    const bool due = (fds[0].revents & POLLIN) != 0 && ::read(fds[0].fd, &expired, sizeof expired) > 0;
    *events = due ? POLLOUT : 0;
    return 0;
}

int close(snd_pcm_ioplug_t* io)
{
    ::close(self(io).timer);
    delete &self(io);
    return 0;
}

const snd_pcm_ioplug_callback_t calls = [] {
    snd_pcm_ioplug_callback_t c = {};
    c.start = start;
    c.stop = stop;
    c.pointer = pointer;
    c.transfer = transfer;
    c.poll_revents = revents;
    c.close = close;
    return c;
}();

} // namespace

extern "C" {

SND_PCM_PLUGIN_DEFINE_FUNC(felt)
{
    (void)root;
    (void)conf;
    auto* f = new felt;
    f->timer = ::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    f->io.version = SND_PCM_IOPLUG_VERSION;
    f->io.name = "felt";
    f->io.callback = &calls;
    f->io.private_data = f;
    f->io.poll_fd = f->timer;
    f->io.poll_events = POLLIN;
    if (const int code = snd_pcm_ioplug_create(&f->io, name, stream, mode); code < 0)
        return code;
    const unsigned accesses[] = {SND_PCM_ACCESS_RW_INTERLEAVED};
    const unsigned formats[] = {SND_PCM_FORMAT_S32_LE};
    snd_pcm_ioplug_set_param_list(&f->io, SND_PCM_IOPLUG_HW_ACCESS, 1, accesses);
    snd_pcm_ioplug_set_param_list(&f->io, SND_PCM_IOPLUG_HW_FORMAT, 1, formats);
    snd_pcm_ioplug_set_param_minmax(&f->io, SND_PCM_IOPLUG_HW_CHANNELS, 1, 64);
    snd_pcm_ioplug_set_param_minmax(&f->io, SND_PCM_IOPLUG_HW_RATE, 48000, 48000);
    snd_pcm_ioplug_set_param_minmax(&f->io, SND_PCM_IOPLUG_HW_PERIOD_BYTES, 256, 1U << 20U);
    snd_pcm_ioplug_set_param_minmax(&f->io, SND_PCM_IOPLUG_HW_PERIODS, 2, 8);
    *pcmp = f->io.pcm;
    return 0;
}

SND_PCM_PLUGIN_SYMBOL(felt);
}
