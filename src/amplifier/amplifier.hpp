// SPDX-License-Identifier: MIT
/// \file
/// When the amplifier is on. Pure: events in, the line's value and a deadline out.
#pragma once

#include <cstdint>
#include <optional>

namespace tactor::engine {

struct amplifier_options {
    std::int64_t settle_ns = 10'000'000;  ///< turn-on time, of silence
    std::uint64_t proof_frames = 192;     ///< the DAC has played so much before it counts as running
    std::int64_t calm_ns = 1'000'000'000; ///< most_xruns within it mute; so long without one ends the mute
    unsigned most_xruns = 2;              ///< so many xruns within calm_ns mute
};

enum class amplifier_event {
    started,   ///< the DAC was started, with silence
    moved,     ///< the DAC has played on, to `at`
    switched,  ///< the line has followed line() to on
    xrun,      ///< the DAC ran dry and stopped
    suspended, ///< the system sleeps
    stalled,   ///< the audio thread stands still
    recovered, ///< it runs again
    lapsed,    ///< the line went off by itself
    silent,    ///< the last sound is out: the stream is about to be stopped
    lost,      ///< the device is gone
    failed,    ///< the device or the line failed
    tick,      ///< time has passed
};

/// Frames of an epoch of the stream.
struct amplifier_frames {
    std::uint64_t played = 0;       ///< so many
    std::uint64_t sounds_until = 0; ///< what is written is silent from this one on, unless a stroke begins
};

/// The order in which nothing pops: the DAC runs with zeros, plays two periods, the line goes on, settle_ns
/// of zeros, strokes; after a mute the same again, when what was written before it is over; and at the end
/// silence, off, and only then the stop of the DAC. A class-D amplifier that is enabled without a running bit
/// clock pops, and so does one that is enabled when the DAC stops.
class amplifier {
public:
    explicit amplifier(const amplifier_options& o) noexcept : options_(o) {}

    /// `now`: CLOCK_MONOTONIC, ns, never less than before.
    void handle(amplifier_event e, std::int64_t now, amplifier_frames at = {}) noexcept;

    /// What the line is to be.
    bool line() const noexcept { return state_ == state::switching || state_ >= state::settling; }
    /// Whether strokes may sound.
    bool ready() const noexcept { return state_ == state::ready; }
    /// Off for good.
    bool ended() const noexcept { return state_ == state::ended; }
    /// When a tick is due, if it can change anything.
    std::optional<std::int64_t> deadline() const noexcept;

private:
    // Line off: ended, stopped, proving. On: the others.
    enum class state { ended, stopped, proving, switching, settling, ready };

    void prove() noexcept;
    void count_xrun(std::int64_t now) noexcept;
    void look(std::int64_t now) noexcept;

    amplifier_options options_;
    state state_ = state::stopped;
    bool stalled_ = false;
    amplifier_frames at_ = {};
    std::uint64_t proof_from_ = 0; ///< proof_frames are counted from here
    std::int64_t settled_at_ = 0;
    std::int64_t muted_until_ = INT64_MIN;
    std::int64_t first_xrun_ = 0; ///< of those that are counted together
    unsigned xruns_ = 0;
};

} // namespace tactor::engine
