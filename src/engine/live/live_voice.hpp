// SPDX-License-Identifier: MIT
/// \file
/// A live stroke between its producer and the audio thread.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tactor/report.hpp>

#include "engine/audio/dac_clock.hpp"
#include "engine/messages.hpp"
#include "rt/triple_buffer.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::engine {

/// Live strokes that the audio thread renders at once.
inline constexpr std::size_t live_voices = 64;
/// These, and live strokes that wait for their first point or for another one to end. More wait on the
/// control side.
inline constexpr std::size_t live_places = voices / 2;

struct live_setup {
    std::size_t channels = 0;
    double cycles_per_frame = 0.0;
    std::uint64_t step = 48; ///< continuous: frames from one set of weights to the next, at least
    std::uint64_t timeout = 24'000;
    std::uint64_t longest = UINT64_MAX; ///< frames that it may sound
    std::uint64_t window = 0;           ///< frames that places are smoothed over; 0: not at all
    bool bursts = false;
    std::uint64_t soa = 0;
    std::uint64_t duration = 0;
    std::uint32_t ramp = 0;     ///< frames, of bursts at whose begin and end the carrier crosses zero
    std::uint32_t cut_ramp = 0; ///< of the others
    bool restart = false;       ///< bursts: each has a carrier of its own, instead of the stroke's
    std::shared_ptr<const synth::timbre> sound = {}; ///< none: a sine
    burst_envelope envelope = {};                    ///< of bursts
    unsigned rate = 48000;
};

/// What the producer hands over: amplitudes now, and as far ahead as they are known.
struct live_course {
    std::uint64_t start = 0;        ///< frame of the stroke that they begin at
    std::uint64_t length = 0;       ///< frames until the last of them holds; 0: at once
    std::int64_t at_ns = 0;         ///< time stamp of the point
    std::size_t knots = 1;          ///< at even distances over the length
    std::vector<double> amplitudes; ///< by knot and channel; space for all that there may be
};

/// Most knots of a course.
inline constexpr std::size_t live_knots = 33;

/// Shortest SOA of live bursts.
inline constexpr double least_live_soa_s = 0.01;

/// Drives of the mixer that one live stroke has at most.
std::size_t live_drives(std::size_t channels, unsigned period_frames, unsigned rate) noexcept;

/// The producer writes amplitudes by channel; the audio thread makes drives of them, period by period, so
/// that no point waits for a plan. All other wishes of the producer are a flag.
class live_voice {
public:
    enum class wish : std::uint32_t { go_on, end, cancel, fail };

    explicit live_voice(const live_setup& s);

    // The producer, one thread at a time.
    live_course& draft() noexcept { return points_.draft(); }
    void publish() noexcept { points_.publish(); }
    /// Frames of the stroke that are rendered: a point that comes now counts from the next frame on.
    std::uint64_t rendered() const noexcept { return rendered_.load(std::memory_order_relaxed); }

    /// Counts a point whose intensity was above 1.
    void count_held() noexcept { held_points_.fetch_add(1, std::memory_order_relaxed); }

    /// Ends it as interrupted, for this reason; once.
    void fail(std::string why) noexcept;

    // Any thread.
    void ask(wish w) noexcept;
    std::uint64_t held_points() const noexcept { return held_points_.load(std::memory_order_relaxed); }
    /// Why it failed; only for a caller that knows that it failed.
    const std::string& failure() const noexcept { return failure_; }
    bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }
    /// It has ended, or will without further points.
    void close() noexcept { closed_.store(true, std::memory_order_release); }

    // The audio thread.
    wish asked() const noexcept { return asked_.load(std::memory_order_acquire); }
    const live_setup& setup() const noexcept { return setup_; }
    bool is_bursts() const noexcept { return setup_.bursts; }
    /// Whether a point waits.
    bool has_news() const noexcept { return points_.has_news(); }
    /// Whether it is still on its way to the newest point, at this frame of the mixer.
    bool moves(std::uint64_t position) const noexcept
    {
        const live_course& c = points_.value();
        return has_begun_ && c.length != 0 && c.start + c.length > position - base_;
    }
    /// Counts so many frames more before it begins. Called by the side that has it meanwhile: the feeder, and
    /// after the hand-over the audio thread.
    void wait(std::uint64_t frames) noexcept;
    /// Whether wait() has seen a point.
    bool has_point() const noexcept { return has_point_; }
    /// Takes the newest point, if one has come; the stroke begins with the mixer's next frame.
    bool try_begin(ticket t, std::uint64_t next) noexcept;
    /// Adds the drives of the next frames. False when the mixer had no space for them. `clock` may be
    /// unknown, `offset` is the stream's frame at which the mixer's begin.
    bool render(synth::mixer& m, std::uint64_t frames, std::uint64_t offset,
                const clock_line& clock) noexcept;
    bool starved() const noexcept { return idle_ > setup_.timeout; }
    /// Whether, at this frame of the mixer, it has sounded as long as it may.
    bool lasted(std::uint64_t position) const noexcept
    {
        return has_begun_ && position - base_ >= setup_.longest;
    }
    /// Continuous: falls to zero in `frames`. False when the mixer had no space.
    bool fade(synth::mixer& m, std::uint32_t frames) noexcept;
    /// Frame at which the drives added so far are over.
    std::uint64_t end() const noexcept { return end_; }
    /// How long its points took; `started_ns`: when its first frame was at the DAC.
    live_delay delay(std::int64_t started_ns) const noexcept;

private:
    /// When the mixer's frames are at the DAC.
    struct dac_times {
        std::uint64_t offset;
        const clock_line& clock;
    };

    bool follow(synth::mixer& m, std::uint64_t frames, const dac_times& t) noexcept;
    bool burst(synth::mixer& m, std::uint64_t at, const dac_times& t) noexcept;
    void take(std::uint64_t at, const dac_times& t) noexcept;
    void aim(std::uint64_t frame) noexcept;
    double amplitude(std::size_t channel) const noexcept;
    template <typename Part>
    bool add(synth::mixer& m, synth::drive_event e, Part part) noexcept;

    live_setup setup_;
    rt::triple_buffer<live_course> points_;
    std::atomic<std::uint64_t> rendered_{0};
    std::atomic<wish> asked_{wish::go_on};
    std::atomic<bool> closed_{false};
    std::atomic<std::uint64_t> held_points_{0};
    std::string failure_;

    ticket ticket_ = 0;
    std::uint64_t base_ = 0;
    std::uint64_t end_ = 0;
    std::uint64_t next_burst_ = 0;
    bool has_point_ = false;
    bool has_begun_ = false;
    std::int64_t first_ns_ = 0; ///< time stamp of the point that it began with
    live_delay later_ = {};     ///< of the others
    std::uint64_t idle_ = 0;    ///< frames since a point came, or since the beginning of the wait
    std::uint64_t length_ = 1;  ///< of the line between two sets of amplitudes
    std::uint64_t place_ = 1;   ///< on it
    std::vector<double> from_;  ///< by channel
    std::vector<double> to_;    ///< of bursts: the next one's
};

} // namespace tactor::engine
