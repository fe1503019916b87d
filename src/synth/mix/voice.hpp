// SPDX-License-Identifier: MIT
/// \file
/// Voices: the form in which the mixer keeps drives. Lists of voices, and the carriers of voices with window,
/// fade and gain.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "synth/wave/event.hpp"
#include "synth/wave/oscillator.hpp"
#include "synth/wave/window.hpp"

namespace tactor::synth {

/// Amplitude on a channel: from + slope * k at frame k of the voice.
struct voice_drive {
    double from;
    double slope;
    std::uint32_t channel;

    /// Returns the largest amplitude in `length` frames.
    double peak(std::uint64_t length) const noexcept
    {
        return std::max(std::abs(from), std::abs(from + slope * static_cast<double>(length)));
    }
};

/// A voice of the mixer. Frames are frames of the stream. `phase`, `stroke_place` and `window_place` are
/// values at frame 0 of the stream, modulo 2^64, so that voices of the same carrier have equal values
/// wherever they start.
struct voice {
    std::uint64_t start = 0;
    std::uint64_t end = 0;
    std::uint64_t order = 0;
    std::uint64_t phase = 0;
    std::uint64_t stroke_place = 0; ///< frame of the stroke, for a timbre
    double cycles_per_frame = 0.0;
    std::uint64_t window_place = 0;
    burst_window window = {};
    std::uint32_t score = 0;
    std::int32_t fade = -1;
    std::uint32_t drives = 0; ///< number of used elements of `drive`
    std::uint32_t points = 0; ///< number of points of `line`, which replaces `drive`; 0 if there is no line
    const timbre* sound = nullptr; ///< null for a sine
    union {
        std::array<voice_drive, drives_per_event> drive{};
        channel_line line;
    };
};

/// Returns true if two voices have the same frequency at each moment, so that they add up with their phases.
bool is_coherent(const voice& a, const voice& b) noexcept;

/// Calls `visit` for each of the voice's channels.
template <class Visit>
void for_each_channel(const voice& v, Visit visit)
{
    for (std::uint32_t i = 0; i < v.drives; ++i)
        visit(v.drive[i].channel);
    if (v.points != 0)
        visit(v.line.channel);
}

/// Frames of the stream in which a channel's amplitude is linear: drive.from + drive.slope * k at start + k.
struct stretch {
    std::uint64_t start = 0;
    std::uint64_t end = 0;
    voice_drive drive = {};

    /// Returns the range (first, end) of the indices j < n for which frame at + j is in the stretch.
    /// Precondition: the range is not empty.
    std::pair<unsigned, unsigned> within(std::uint64_t at, unsigned n) const noexcept
    {
        return {static_cast<unsigned>(std::max(start, at) - at),
                static_cast<unsigned>(std::min(end, at + n) - at)};
    }
};

/// Calls `visit` for each stretch of each channel that overlaps the n frames from frame `at` on. The
/// stretches of a line come in order of time. Skips stretches of amplitude 0.
template <class Visit>
void for_each_stretch(const voice& v, std::uint64_t at, unsigned n, Visit visit)
{
    const auto look = [&](std::uint64_t start, std::uint64_t end) { return start < at + n && end > at; };
    for (std::uint32_t i = 0; i < v.drives && look(v.start, v.end); ++i)
        visit(stretch{v.start, v.end, v.drive[i]});
    for (std::uint32_t i = 0; i + 1 < v.points; ++i) {
        const double from = v.line.amplitude[i];
        const double to = v.line.amplitude[i + 1];
        const std::uint64_t start = v.start + v.line.frame[i];
        const std::uint64_t end = v.start + v.line.frame[i + 1];
        if (start >= at + n)
            return;
        if (end > at && (from != 0.0 || to != 0.0))
            visit(
                stretch{start, end, {from, (to - from) / static_cast<double>(end - start), v.line.channel}});
    }
}

/// Makes the voice of an event. Skips channels that are not below `channels`, and drives that are not finite.
voice make_voice(const drive_event& e, std::size_t channels) noexcept;

/// A fixed number of voices. Some wait in a heap; the others sound, always in the order of (start, arrival),
/// so that sums have the same order whatever the block sizes.
class voice_list {
public:
    explicit voice_list(std::size_t capacity);

    std::size_t available() const noexcept { return free_.size(); }
    std::size_t size() const noexcept { return voices_.size() - free_.size(); }

    /// Adds a voice. There must be space.
    void add(voice v) noexcept;
    /// Activates the voices that start before a frame.
    void activate(std::uint64_t before) noexcept;
    /// Returns the frame at which the next waiting voice starts, or the greatest number if none waits.
    std::uint64_t next_start() const noexcept;

    /// Returns the voices that sound, in order.
    std::span<const std::uint32_t> active() const noexcept { return active_; }
    voice& operator[](std::uint32_t slot) noexcept { return voices_[slot]; }

    /// Removes the sounding voices that have ended by a frame.
    void retire(std::uint64_t by) noexcept;
    /// Removes the voices, waiting or sounding, for which test(voice&) returns true. Takes linear time.
    template <class Test>
    void remove_if(Test test) noexcept;
    void clear() noexcept;

private:
    struct waiting {
        std::uint64_t start;
        std::uint64_t order;
        std::uint32_t slot;
        auto operator<=>(const waiting&) const = default;
    };
    template <class Test>
    void remove_active_if(Test test) noexcept;

    std::vector<voice> voices_;
    std::vector<std::uint32_t> free_;
    std::vector<waiting> heap_; ///< the earliest first
    std::vector<std::uint32_t> active_;
    std::uint64_t arrivals_ = 0;
    std::uint64_t earliest_end_ = ~std::uint64_t{0};
};

template <class Test>
void voice_list::remove_active_if(Test test) noexcept
{
    std::size_t rest = 0;
    earliest_end_ = ~std::uint64_t{0};
    for (const std::uint32_t slot : active_) {
        if (test(voices_[slot])) {
            free_.push_back(slot);
        } else {
            active_[rest++] = slot;
            earliest_end_ = voices_[slot].end < earliest_end_ ? voices_[slot].end : earliest_end_;
        }
    }
    active_.resize(rest);
}

template <class Test>
void voice_list::remove_if(Test test) noexcept
{
    remove_active_if(test);
    std::size_t rest = 0;
    for (const waiting& w : heap_)
        if (test(voices_[w.slot]))
            free_.push_back(w.slot);
        else
            heap_[rest++] = w;
    heap_.resize(rest);
    std::make_heap(heap_.begin(), heap_.end(), std::greater<>{});
}

/// Factor of a score: `from` until frame `start`, then linear to `to`, which it reaches `length` frames
/// later.
struct score_gain {
    std::uint32_t score = 0;
    double from = 1.0;
    double to = 1.0;
    std::uint64_t start = 0;
    std::uint64_t length = 0;

    /// Returns true if `to` is reached at a frame.
    bool is_over(std::uint64_t frame) const noexcept { return frame >= start && frame - start >= length; }
    double at(std::uint64_t frame) const noexcept
    {
        if (frame < start)
            return from;
        if (is_over(frame))
            return to;
        return from + (to - from) * static_cast<double>(frame - start) / static_cast<double>(length);
    }
    /// Multiplies the n samples from a frame on.
    void apply(std::uint64_t frame, unsigned n, double* samples) const noexcept;
    bool operator==(const score_gain&) const = default;
};

/// A fixed number of factors. A score without an entry has the factor 1.
class score_gains {
public:
    /// Returns the factor of a score, or null if it is 1 from this frame on.
    const score_gain* find(std::uint32_t score, std::uint64_t frame) const noexcept;
    /// Moves the factor of a score to `to` within `length` frames from frame `at` on. Returns false if all
    /// factors are in use.
    bool set(std::uint32_t score, double to, std::uint64_t at, std::uint64_t length) noexcept;
    void forget(std::uint32_t score) noexcept;
    /// Ends all ramps: each factor takes its final value.
    void end_ramps() noexcept;

private:
    /// Returns the index of a score's factor, or used_ if it has none.
    std::size_t place(std::uint32_t score) const noexcept
    {
        const auto end = gains_.begin() + static_cast<std::ptrdiff_t>(used_);
        return static_cast<std::size_t>(
            std::find_if(gains_.begin(), end, [score](const score_gain& g) { return g.score == score; }) -
            gains_.begin());
    }

    std::array<score_gain, 512> gains_{};
    std::size_t used_ = 0; ///< number of factors in use
};

struct fade {
    bool used = false;
    std::uint32_t score = 0;
    std::uint64_t start = 0;
    std::uint64_t length = 0;
    std::uint64_t end() const noexcept { return start + length; }
};

/// A fixed number of fades.
class fades {
public:
    static constexpr std::int32_t none = -1;

    bool any() const noexcept { return used_ != 0; }
    /// Returns the index of a score's fade, or `none`.
    std::int32_t find(std::uint32_t score) const noexcept;
    /// Begins a fade. Returns its index, or `none` if all fades are in use.
    std::int32_t begin(std::uint32_t score, std::uint64_t start, std::uint64_t length) noexcept;
    void end(std::int32_t i) noexcept;
    void clear() noexcept;
    const fade& operator[](std::int32_t i) const noexcept { return fades_[static_cast<std::size_t>(i)]; }
    bool any_ended(std::uint64_t by) const noexcept;
    /// Frees the fades that have ended by a frame.
    void end_all(std::uint64_t by) noexcept;

private:
    std::array<fade, 256> fades_{};
    std::uint32_t used_ = 0;
};

/// Cache of the latest carrier block: the events of a burst, or of a continuous stroke, need the same block.
class carrier_block {
public:
    /// Returns the samples of a voice in n frames (at most block_frames) from frame `at` of the stream on,
    /// with the fade `f` and the factor `g`, which may be null. Valid until the next call for the same wave.
    const double* get(const voice& v, const fade* f, const score_gain* g, std::uint64_t at, unsigned n,
                      wave w) noexcept;
    /// Returns true if `s`, which get() returned for the sine, has no window, fade or gain.
    bool is_plain(const double* s) const noexcept { return s == entries_[0].plain.data(); }
    void forget() noexcept;

private:
    struct place {
        std::uint64_t at = ~std::uint64_t{0};
        unsigned n = 0;
        double cycles_per_frame = 0.0;
        std::uint64_t phase = 0;
        std::uint64_t stroke_place = 0;
        const timbre* sound = nullptr;
        bool operator==(const place&) const = default;
    };
    struct shape {
        std::uint64_t window_place = 0;
        burst_window window = {};
        std::int64_t fade_place = 0;
        std::uint64_t fade_length = 0;
        score_gain gain = {};
        bool operator==(const shape&) const = default;
    };
    struct entry {
        place plain_place;
        place shaped_place;
        shape shaped_shape;
        alignas(64) block plain{};
        alignas(64) block shaped{};
    };
    oscillator_tables tables_;
    std::array<entry, 2> entries_; ///< by wave
};

/// Adds amplitude * s[j] to sum[j] for each of n frames, from frame `at` of the stream on, that lies in the
/// stretch.
void add_stretch(const double* s, const stretch& p, std::uint64_t at, unsigned n, double* sum) noexcept;

} // namespace tactor::synth
