// SPDX-License-Identifier: MIT
/// \file
/// A live stroke: its voice in the audio thread, and the producer's side. The producer's side turns points
/// that arrive irregularly into an even movement, and computes its amplitudes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/phantom.hpp>
#include <tactor/player.hpp>
#include <tactor/sink.hpp>

#include "engine/dac_clock.hpp"
#include "engine/link.hpp"
#include "rt/triple_buffer.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::engine {

/// Maximum number of live strokes that the audio thread renders at once.
inline constexpr std::size_t live_voices = 64;
/// Maximum number of live strokes that the audio thread holds, including those that wait for their first
/// point or for another stroke to end. Further strokes wait on the control side.
inline constexpr std::size_t live_places = voices / 2;

struct live_setup {
    std::size_t channels = 0;
    double cycles_per_frame = 0.0;
    std::uint64_t step = 48; ///< continuous strokes: minimum number of frames between two sets of weights
    std::uint64_t timeout = 24'000;
    std::uint64_t longest = UINT64_MAX; ///< maximum number of frames for which the stroke sounds
    std::uint64_t window = 0;           ///< frames over which places are smoothed; 0 for no smoothing
    bool bursts = false;
    std::uint64_t soa = 0;
    std::uint64_t duration = 0;
    std::uint32_t ramp = 0;     ///< ramp of bursts whose carrier is at zero at both ends, frames
    std::uint32_t cut_ramp = 0; ///< ramp of other bursts, frames
    bool restart = false;       ///< true if each burst restarts the carrier, false if the carrier continues
    std::shared_ptr<const synth::timbre> sound = {}; ///< null for a sine
    burst_envelope envelope = {};                    ///< envelope of bursts
    unsigned rate = 48000;
};

/// Amplitudes that the producer hands over, from now until the stroke has reached the newest point.
struct live_course {
    std::uint64_t start = 0;  ///< frame of the stroke at which the amplitudes begin
    std::uint64_t length = 0; ///< frames from the first set to the last; 0: the last set applies at once
    std::int64_t at_ns = 0;   ///< time stamp of the point
    std::size_t knots = 1;    ///< number of sets of amplitudes, evenly spaced over `length`
    std::vector<double> amplitudes; ///< by knot and channel; sized for the maximum number of knots
};

/// Returns the number of the mixer's drives that are reserved for live strokes.
std::size_t live_reserve(const stream_setup& s) noexcept;

/// A live stroke. The producer writes amplitudes by channel, and the audio thread turns them into drives in
/// each period, so points need no plan. The producer's other requests set a flag.
class live_voice {
public:
    enum class action : std::uint32_t { go_on, end, cancel, fail };

    explicit live_voice(const live_setup& s);

    // Producer: one thread at a time.
    live_course& draft() noexcept { return points_.draft(); }
    void publish() noexcept { points_.publish(); }
    /// Returns the number of frames of the stroke that have been rendered. A point that arrives now takes
    /// effect from the next frame on.
    std::uint64_t rendered() const noexcept { return rendered_.load(std::memory_order_relaxed); }

    /// Counts a point that was held because its intensity was above 1, or that was outside the array.
    void count_held_point() noexcept { held_points_.fetch_add(1, std::memory_order_relaxed); }
    void count_outside_point() noexcept { outside_points_.fetch_add(1, std::memory_order_relaxed); }
    /// Adds a point to the length and the duration that doubt() examines. `at_ns`: the point's time stamp.
    void record_movement(point p, std::int64_t at_ns) noexcept;

    /// Ends the stroke as interrupted, with `why` as the reason. Call it at most once.
    void fail(std::string why) noexcept;

    // Any thread.
    void request(action w) noexcept;
    std::uint64_t held_points() const noexcept { return held_points_.load(std::memory_order_relaxed); }
    std::uint64_t outside_points() const noexcept { return outside_points_.load(std::memory_order_relaxed); }
    /// Returns a warning if the points are probably not in millimetres, else an empty string.
    std::string doubt() const;
    /// Returns the reason of the failure. Call it only after the stroke has failed.
    const std::string& failure() const noexcept { return failure_; }
    bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }
    /// Marks the stroke as ended, or as about to end without further points.
    void close() noexcept { closed_.store(true, std::memory_order_release); }

    // Audio thread.
    action requested() const noexcept { return requested_.load(std::memory_order_acquire); }
    const live_setup& setup() const noexcept { return setup_; }
    bool plays_bursts() const noexcept { return setup_.bursts; }
    /// Returns true if a new point waits.
    bool has_new_value() const noexcept { return points_.has_new_value(); }
    /// Returns true if the stroke has not reached the newest point yet at this frame of the mixer.
    bool moves(std::uint64_t position) const noexcept
    {
        const live_course& c = points_.value();
        return has_begun_ && c.length != 0 && c.start + c.length > position - base_;
    }
    /// Adds `frames` to the time that the stroke has waited to begin. The feeder calls this before it hands
    /// the stroke over, the audio thread afterwards.
    void wait(std::uint64_t frames) noexcept;
    /// Returns true if wait() has seen a point.
    bool has_point() const noexcept { return has_point_; }
    /// Takes the newest point and begins the stroke at the mixer's frame `next`. Returns false if no point
    /// has come.
    bool try_begin(ticket t, std::uint64_t next) noexcept;
    /// Adds the drives of the next frames. Returns false if the mixer has no space for them. `clock` may be
    /// invalid; `offset` is the stream frame of the mixer's frame 0.
    bool render(synth::mixer& m, std::uint64_t frames, std::uint64_t offset,
                const clock_line& clock) noexcept;
    bool starved() const noexcept { return idle_ > setup_.timeout; }
    /// Returns true if the stroke has reached its maximum duration at this frame of the mixer.
    bool reached_max_duration(std::uint64_t position) const noexcept
    {
        return has_begun_ && position - base_ >= setup_.longest;
    }
    /// Fades a continuous stroke to zero within `frames`. Returns false if the mixer has no space.
    bool fade(synth::mixer& m, std::uint32_t frames) noexcept;
    /// Returns the frame at which the drives added so far end.
    std::uint64_t end() const noexcept { return end_; }
    /// Returns the delays of the points. `started_ns`: time when the stroke's first frame was at the DAC.
    live_delay delay(std::int64_t started_ns) const noexcept;

private:
    /// Times at which the mixer's frames are at the DAC.
    struct dac_times {
        std::uint64_t offset;
        const clock_line& clock;
    };

    bool follow(synth::mixer& m, std::uint64_t frames, const dac_times& t) noexcept;
    bool add_burst(synth::mixer& m, std::uint64_t at, const dac_times& t) noexcept;
    void take(std::uint64_t at, const dac_times& t) noexcept;
    void set_target_amplitudes(std::uint64_t frame) noexcept;
    double amplitude(std::size_t channel) const noexcept;
    template <typename Part>
    bool add(synth::mixer& m, synth::drive_event e, Part part) noexcept;

    live_setup setup_;
    rt::triple_buffer<live_course> points_;
    std::atomic<std::uint64_t> rendered_{0};
    std::atomic<action> requested_{action::go_on};
    std::atomic<bool> closed_{false};
    std::atomic<std::uint64_t> held_points_{0};
    std::atomic<std::uint64_t> outside_points_{0};
    std::atomic<double> length_mm_{0.0};
    std::atomic<double> farthest_mm_{0.0};
    std::atomic<double> moving_s_{0.0};
    std::optional<point> newest_ = {}; ///< used only by the producer, like begun_ns_
    std::int64_t begun_ns_ = 0;
    std::string failure_;

    ticket ticket_ = 0;
    std::uint64_t base_ = 0;
    std::uint64_t end_ = 0;
    std::uint64_t next_burst_ = 0;
    bool has_point_ = false;
    bool has_begun_ = false;
    std::int64_t first_ns_ = 0; ///< time stamp of the point with which the stroke began
    live_delay later_ = {};     ///< delays of all points but the first
    std::uint64_t idle_ = 0;    ///< frames since the last point, or since the wait began
    std::uint64_t length_ = 1;  ///< length of the line between two sets of amplitudes
    std::uint64_t place_ = 1;   ///< position on that line
    std::vector<double> from_;  ///< amplitudes at the start of that line, by channel
    std::vector<double> to_;    ///< amplitudes at the end of that line, or of the next burst
};

/// Smoothed place of a stroke: the mean of its points over a window that ends now. A jump becomes an even
/// movement that lasts one window, and an even movement is delayed by half a window. At intensity 0 nothing
/// touches the skin, so a place with intensity 0 counts only if all places in the window have intensity 0.
class smoothing {
public:
    struct place {
        point at;
        double intensity = 1.0;
    };

    /// \param window frames, 1 or more
    explicit smoothing(std::uint64_t window) : window_(window) {}

    /// Puts the stroke at `p` from this frame on. `frame` must not decrease. A second place for the same
    /// frame replaces the first. Before the first frame the stroke rests at the first place.
    void to(std::uint64_t frame, const place& p);
    /// Returns the place at `frame` if no further place comes. `frame` must not be before the newest place.
    place at(std::uint64_t frame) const;
    /// Returns the number of frames that the stroke takes to reach the newest place.
    std::uint64_t frames_to_target() const noexcept { return places_.size() < 2 ? 0 : window_; }

private:
    struct entry {
        std::uint64_t from;
        place where;
    };

    std::uint64_t window_;
    std::vector<entry> places_; ///< places that still count, oldest first
};

} // namespace tactor::engine

namespace tactor {
inline namespace v0 {

struct live_stroke::impl {
    /// Prepares the stroke.
    /// \throws error (bad_input) for impossible options.
    impl(stroke_id number, const array& a, const layout& l, const stream_setup& s, const live_options& o);

    bool to(point p, double intensity, std::optional<std::int64_t> at_ns = {});
    /// Writes the amplitudes of a place, by channel. Returns true if a limit lowered an amplitude. Sets
    /// `excess` if the model's amplitudes exceed the requested intensity.
    bool write_amplitudes(point p, double intensity, std::span<double> by_channel);
    /// Writes the amplitudes from the current place to `p`. Ends the stroke if the model fails.
    bool write_course(point p, double intensity);
    /// Computes the amplitudes from the current place to `p` into `course`.
    bool compute_course(const engine::smoothing::place& p, engine::live_course& course);

    stroke_id id;
    layout faces;
    std::shared_ptr<const phantom_model> model;
    outside_kind outside;
    intensity_scale scale;
    std::vector<synth::tactor_level> levels; ///< by tactor
    std::vector<double> limits;              ///< by channel
    engine::live_voice voice;

    std::uint64_t window; ///< frames; 0 if places are not smoothed

    std::mutex mutex; ///< lets one producer in at a time
    /// Thread that runs the phantom model now. If the model, which may be the program's code, moved the
    /// stroke, this thread would wait for itself.
    std::atomic<std::thread::id> model_thread{};
    engine::smoothing smooth;
    std::size_t most_knots;
    std::vector<drive> drives;
    std::string excess; ///< reason why the stroke is about to fail
    std::atomic<std::uint64_t> points{0};
    std::atomic<std::uint64_t> limited_points{0};
};

} // namespace v0
} // namespace tactor
