// SPDX-License-Identifier: MIT
/// \file
/// A DAC in this process: a real snd_pcm_t whose clock moves only when the test says so.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include <alsa/asoundlib.h>
#include <alsa/pcm_external.h>

namespace tactor::test {

struct fake_dac_options {
    std::vector<snd_pcm_format_t> formats{SND_PCM_FORMAT_S32_LE, SND_PCM_FORMAT_S16_LE,
                                          SND_PCM_FORMAT_FLOAT_LE};
    unsigned least_channels = 1;
    unsigned most_channels = 64;
    std::vector<unsigned> channel_counts{}; ///< these only, instead
    unsigned rate = 48000;
    bool planar = false; ///< takes a block for each channel, as RME's cards do
    std::size_t least_period_bytes = 32;
    std::size_t most_buffer_bytes = 1 << 20;
};

/// An ALSA ioplug. Must outlive the PCM. The members may be called while other threads use the PCM.
class fake_dac {
public:
    explicit fake_dac(const fake_dac_options& o = {});
    fake_dac(const fake_dac&) = delete;
    fake_dac& operator=(const fake_dac&) = delete;
    ~fake_dac();

    /// The PCM, for tactor::alsa::adopt() to own.
    snd_pcm_t* pcm() noexcept
    {
        taken_ = true;
        return io_.pcm;
    }

    /// Plays frames; the stream has an xrun where there are none left.
    void advance(std::uint64_t frames);
    /// Does the same, but plays at most the queued frames, so never with an xrun. Returns their number.
    std::uint64_t advance_queued(std::uint64_t frames);

    void suspend();             ///< the system sleeps
    void wake(bool can_resume); ///< resume() works from now on (or says ENOSYS)
    void disconnect();          ///< unplugged
    void fail_prepare(int code) { fail_prepare_ = code; }
    void fail_start(int code) { fail_start_ = code; }
    /// Makes every poll look ready.
    void cry_ready(bool on);
    /// Hides its descriptors in an xrun, like dmix.
    void hide_descriptors_in_xrun()
    {
        const std::lock_guard lock(mutex_);
        hides_descriptors_ = true;
    }
    /// Number of polls while it had no descriptors; dmix ends the process then.
    unsigned asked_in_vain() const { return look(asked_in_vain_); }

    /// Returns all bytes that were transferred so far, over all epochs, from a frame on: whole frames, also
    /// of a planar device.
    std::vector<std::byte> captured(std::uint64_t from = 0) const;
    std::size_t captured_frames() const { return look(total_); }
    std::size_t frame_bytes() const { return look(frame_bytes_); }
    std::uint64_t queued() const
    {
        const std::lock_guard lock(mutex_);
        return queued_locked();
    }
    unsigned starts() const { return look(starts_); }
    unsigned prepares() const { return look(prepares_); }
    bool closed() const { return look(closed_); }
    bool running() const { return look(running_); }

    /// Blocks until the condition holds; checks it at each event of the device.
    template <typename Condition>
    void await(Condition c)
    {
        for (;;) {
            std::unique_lock lock(mutex_);
            const std::uint64_t seen = events_;
            lock.unlock();
            if (c())
                return;
            lock.lock();
            changed_.wait(lock, [&] { return events_ != seen; });
        }
    }

    /// Reserves memory for what will be captured; no more than that is kept.
    void reserve_capture(std::size_t bytes);
    /// Keeps the frames captured so far, and no more.
    void stop_capture();

private:
    struct callbacks;
    static const snd_pcm_ioplug_callback_t table;

    template <class T>
    T look(const T& member) const
    {
        const std::lock_guard lock(mutex_);
        return member;
    }
    void happened();
    void update_readiness();
    std::uint64_t queued_locked() const { return transferred_ - clock_; }

    snd_pcm_ioplug_t io_{};
    int event_ = -1;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::uint64_t events_ = 0;
    std::vector<std::byte> captured_;
    std::size_t capture_limit_ = SIZE_MAX;
    std::size_t frame_bytes_ = 0;
    std::uint64_t total_ = 0;
    std::uint64_t clock_ = 0;       ///< frames of this epoch that left
    std::uint64_t transferred_ = 0; ///< frames of this epoch that came in
    bool starved_ = false;
    bool suspended_ = false;
    bool disconnected_ = false;
    bool cry_ready_ = false;
    bool closed_ = false;
    bool taken_ = false;
    bool running_ = false;
    int resume_code_ = -EAGAIN;
    int fail_prepare_ = 0;
    int fail_start_ = 0;
    unsigned starts_ = 0;
    unsigned prepares_ = 0;
    bool hides_descriptors_ = false;
    unsigned asked_in_vain_ = 0;
};

} // namespace tactor::test
