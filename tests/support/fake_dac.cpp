// SPDX-License-Identifier: MIT
#include "fake_dac.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace tactor::test {

struct fake_dac::callbacks {
    static fake_dac& self(snd_pcm_ioplug_t* io) { return *static_cast<fake_dac*>(io->private_data); }

    // The state belongs to the thread that uses the PCM, so faults are applied where it calls in.
    static void apply_faults(fake_dac& d)
    {
        if (d.disconnected_)
            snd_pcm_ioplug_set_state(&d.io_, SND_PCM_STATE_DISCONNECTED);
        else if (d.suspended_ && d.running_)
            snd_pcm_ioplug_set_state(&d.io_, SND_PCM_STATE_SUSPENDED);
        else if (d.starved_)
            snd_pcm_ioplug_set_state(&d.io_, SND_PCM_STATE_XRUN);
    }

    static int start(snd_pcm_ioplug_t* io)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        if (d.fail_start_ != 0)
            return d.fail_start_;
        d.running_ = true;
        ++d.starts_;
        d.happened();
        return 0;
    }

    static int stop(snd_pcm_ioplug_t* io)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        d.running_ = false;
        d.happened();
        return 0;
    }

    static snd_pcm_sframes_t pointer(snd_pcm_ioplug_t* io)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        apply_faults(d);
        if (d.starved_)
            return -EPIPE;
        return static_cast<snd_pcm_sframes_t>(d.clock_);
    }

    static const std::byte* sample(const snd_pcm_channel_area_t& a, snd_pcm_uframes_t frame)
    {
        return static_cast<const std::byte*>(a.addr) + (a.first + frame * a.step) / 8;
    }

    static snd_pcm_sframes_t transfer(snd_pcm_ioplug_t* io, const snd_pcm_channel_area_t* areas,
                                      snd_pcm_uframes_t offset, snd_pcm_uframes_t size)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        const std::size_t space = d.capture_limit_ - std::min(d.capture_limit_, d.captured_.size());
        if (io->access == SND_PCM_ACCESS_RW_INTERLEAVED) {
            const std::byte* from = sample(areas[0], offset);
            d.captured_.insert(d.captured_.end(), from, from + std::min(size * d.frame_bytes_, space));
        } else {
            for (std::size_t f = 0; f < std::min(size, space / d.frame_bytes_); ++f)
                for (unsigned c = 0; c < io->channels; ++c) {
                    const std::byte* from = sample(areas[c], offset + f);
                    d.captured_.insert(d.captured_.end(), from, from + d.frame_bytes_ / io->channels);
                }
        }
        d.transferred_ += size;
        d.total_ += size;
        d.happened();
        return static_cast<snd_pcm_sframes_t>(size);
    }

    static int close(snd_pcm_ioplug_t* io)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        d.closed_ = true;
        d.running_ = false;
        d.happened();
        return 0;
    }

    static int prepare(snd_pcm_ioplug_t* io)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        if (d.disconnected_)
            return -ENODEV;
        if (d.suspended_)
            return -ESTRPIPE;
        if (d.fail_prepare_ != 0)
            return d.fail_prepare_;
        d.frame_bytes_ =
            static_cast<std::size_t>(snd_pcm_format_physical_width(io->format)) / 8 * io->channels;
        d.clock_ = 0;
        d.transferred_ = 0;
        d.starved_ = false;
        d.running_ = false;
        ++d.prepares_;
        d.happened();
        return 0;
    }

    static int resume(snd_pcm_ioplug_t* io)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        if (d.resume_code_ == 0) {
            d.suspended_ = false;
            snd_pcm_ioplug_set_state(io, SND_PCM_STATE_RUNNING);
        }
        d.happened();
        return d.resume_code_;
    }

    static int poll_descriptors(snd_pcm_ioplug_t* io, pollfd* fds, unsigned)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        if (d.hides_descriptors_ && d.starved_)
            return -EPIPE;
        *fds = {.fd = d.event_, .events = POLLIN, .revents = 0};
        return 1;
    }

    static int poll_revents(snd_pcm_ioplug_t* io, pollfd*, unsigned count, unsigned short* revents)
    {
        fake_dac& d = self(io);
        const std::lock_guard lock(d.mutex_);
        d.asked_in_vain_ += count == 1 ? 0 : 1;
        apply_faults(d);
        *revents = 0;
        if (d.disconnected_)
            *revents = POLLERR | POLLNVAL;
        else if (d.starved_ || d.suspended_)
            *revents = POLLERR | POLLOUT;
        else if (d.cry_ready_ || io->buffer_size - d.queued_locked() >= io->period_size)
            *revents = POLLOUT;
        return 0;
    }
};

namespace {

void must(int code)
{
    if (code < 0)
        throw std::runtime_error(snd_strerror(code));
}

void limit(snd_pcm_ioplug_t& io, const fake_dac_options& o)
{
    const unsigned access = o.planar ? SND_PCM_ACCESS_RW_NONINTERLEAVED : SND_PCM_ACCESS_RW_INTERLEAVED;
    must(snd_pcm_ioplug_set_param_list(&io, SND_PCM_IOPLUG_HW_ACCESS, 1, &access));
    std::vector<unsigned> formats;
    for (const snd_pcm_format_t f : o.formats)
        formats.push_back(static_cast<unsigned>(f));
    must(snd_pcm_ioplug_set_param_list(&io, SND_PCM_IOPLUG_HW_FORMAT, static_cast<unsigned>(formats.size()),
                                       formats.data()));
    if (o.channel_counts.empty())
        must(snd_pcm_ioplug_set_param_minmax(&io, SND_PCM_IOPLUG_HW_CHANNELS, o.least_channels,
                                             o.most_channels));
    else
        must(snd_pcm_ioplug_set_param_list(&io, SND_PCM_IOPLUG_HW_CHANNELS,
                                           static_cast<unsigned>(o.channel_counts.size()),
                                           o.channel_counts.data()));
    must(snd_pcm_ioplug_set_param_minmax(&io, SND_PCM_IOPLUG_HW_RATE, o.rate, o.rate));
    const auto most = static_cast<unsigned>(o.most_buffer_bytes);
    const auto least = static_cast<unsigned>(o.least_period_bytes);
    must(snd_pcm_ioplug_set_param_minmax(&io, SND_PCM_IOPLUG_HW_PERIOD_BYTES, least, most / 2));
    must(snd_pcm_ioplug_set_param_minmax(&io, SND_PCM_IOPLUG_HW_BUFFER_BYTES, 2 * least, most));
    must(snd_pcm_ioplug_set_param_minmax(&io, SND_PCM_IOPLUG_HW_PERIODS, 2, 1024));
}

} // namespace

const snd_pcm_ioplug_callback_t fake_dac::table = [] {
    snd_pcm_ioplug_callback_t t{};
    t.start = callbacks::start;
    t.stop = callbacks::stop;
    t.pointer = callbacks::pointer;
    t.transfer = callbacks::transfer;
    t.close = callbacks::close;
    t.prepare = callbacks::prepare;
    t.resume = callbacks::resume;
    t.poll_descriptors = callbacks::poll_descriptors;
    t.poll_revents = callbacks::poll_revents;
    return t;
}();

fake_dac::fake_dac(const fake_dac_options& o) : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC))
{
    must(event_);
    io_.version = SND_PCM_IOPLUG_VERSION;
    io_.name = "fake DAC";
    io_.flags = SND_PCM_IOPLUG_FLAG_MONOTONIC | SND_PCM_IOPLUG_FLAG_BOUNDARY_WA;
    io_.poll_fd = event_;
    io_.poll_events = POLLIN;
    io_.callback = &table;
    io_.private_data = this;
    must(snd_pcm_ioplug_create(&io_, "fake", SND_PCM_STREAM_PLAYBACK, SND_PCM_NONBLOCK));
    limit(io_, o);
    // The flag of create() does not reach the plugin.
    must(snd_pcm_nonblock(io_.pcm, 1));
}

fake_dac::~fake_dac()
{
    if (!taken_) // else its owner closes it
        snd_pcm_close(io_.pcm);
    ::close(event_);
}

void fake_dac::happened()
{
    update_readiness();
    ++events_;
    changed_.notify_all();
}

void fake_dac::update_readiness()
{
    const bool ready = cry_ready_ || disconnected_ || suspended_ || starved_ ||
                       io_.buffer_size - queued_locked() >= io_.period_size;
    std::uint64_t n = ready ? 1 : 0;
    if (ready)
        (void)!::write(event_, &n, sizeof n);
    else
        (void)!::read(event_, &n, sizeof n);
}

void fake_dac::advance(std::uint64_t frames)
{
    const std::lock_guard lock(mutex_);
    if (!running_ || starved_ || suspended_ || disconnected_)
        return;
    // The DAC stops where the buffer is empty, as its stop threshold says.
    starved_ = frames >= queued_locked();
    clock_ += std::min(frames, queued_locked());
    happened();
}

std::uint64_t fake_dac::advance_queued(std::uint64_t frames)
{
    const std::lock_guard lock(mutex_);
    if (!running_ || starved_ || suspended_ || disconnected_ || queued_locked() == 0)
        return 0;
    const std::uint64_t n = std::min(frames, queued_locked() - 1);
    clock_ += n;
    happened();
    return n;
}

void fake_dac::suspend()
{
    const std::lock_guard lock(mutex_);
    suspended_ = true;
    resume_code_ = -EAGAIN;
    happened();
}

void fake_dac::wake(bool can_resume)
{
    const std::lock_guard lock(mutex_);
    resume_code_ = can_resume ? 0 : -ENOSYS;
    if (!can_resume)
        suspended_ = false;
    happened();
}

void fake_dac::disconnect()
{
    const std::lock_guard lock(mutex_);
    disconnected_ = true;
    happened();
}

void fake_dac::cry_ready(bool on)
{
    const std::lock_guard lock(mutex_);
    cry_ready_ = on;
    happened();
}

std::vector<std::byte> fake_dac::captured(std::uint64_t from) const
{
    const std::lock_guard lock(mutex_);
    const std::uint64_t first = std::min<std::uint64_t>(from * frame_bytes_, captured_.size());
    return {captured_.begin() + static_cast<std::ptrdiff_t>(first), captured_.end()};
}

void fake_dac::reserve_capture(std::size_t bytes)
{
    const std::lock_guard lock(mutex_);
    captured_.reserve(bytes);
    capture_limit_ = bytes;
}

void fake_dac::stop_capture()
{
    const std::lock_guard lock(mutex_);
    capture_limit_ = captured_.size();
}

} // namespace tactor::test
