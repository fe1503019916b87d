// SPDX-License-Identifier: MIT
/// \file
/// State of the amplifier. Pure: it takes events and returns the line's value and a deadline.
#pragma once

#include <cstdint>
#include <optional>

namespace tactor::amplifier {

struct sequence_options {
    std::int64_t settle_ns = 10'000'000; ///< turn-on time of the amplifier, spent in silence
    std::uint64_t proof_frames = 192;    ///< frames that the DAC must play before it counts as running
    std::int64_t calm_ns =
        1'000'000'000; ///< most_xruns xruns within this time mute; the same time without an xrun unmutes
    unsigned most_xruns = 2; ///< number of xruns within calm_ns that mutes
};

enum class event {
    started,   ///< the DAC started, with silence
    moved,     ///< the DAC has played on, up to `at`
    switched,  ///< the line has been switched on, as line() requested
    xrun,      ///< the DAC ran dry and stopped
    suspended, ///< the system sleeps
    stalled,   ///< the audio thread stands still
    recovered, ///< the audio thread runs again
    lapsed,    ///< the line went off by itself
    withheld,  ///< the line must stay off, such as before the system sleeps
    granted,   ///< the line may go on again
    silent,    ///< the last sound is out: the stream is about to stop
    failed,    ///< the device or the line failed
    tick,      ///< time has passed
};

/// Frames of an epoch of the stream.
struct played_frames {
    std::uint64_t played = 0;       ///< frames at the DAC
    std::uint64_t sounds_until = 0; ///< written frames from here on are silent, unless a stroke begins
};

/// State machine that switches in an order without pops. At the start the DAC plays zeros for proof_frames,
/// then the line goes on, then zeros follow for settle_ns, and then strokes may sound. After a mute this
/// order repeats once the frames written before the mute are over. At the end comes silence, then the line
/// goes off, and only then the DAC stops. A class-D amplifier pops if it is enabled without a running bit
/// clock, and if the DAC stops while it is enabled.
class sequence {
public:
    explicit sequence(const sequence_options& o) noexcept : options_(o) {}

    /// Processes an event. `now`: CLOCK_MONOTONIC, ns, never less than before.
    void handle(event e, std::int64_t now, played_frames at = {}) noexcept;

    /// Returns the value that the line must have.
    bool line() const noexcept { return state_ == state::switching || state_ >= state::settling; }
    /// Returns true if strokes may sound.
    bool ready() const noexcept { return state_ == state::ready; }
    /// Returns the time when a tick can change the state, if any.
    std::optional<std::int64_t> deadline() const noexcept;

private:
    // The line is off while ended, stopped or proving, and on otherwise.
    enum class state { ended, stopped, proving, switching, settling, ready };

    void begin_proof() noexcept;
    void count_xrun(std::int64_t now) noexcept;
    void look(std::int64_t now) noexcept;

    sequence_options options_;
    state state_ = state::stopped;
    bool stalled_ = false;
    bool withheld_ = false;
    played_frames at_ = {};
    std::uint64_t proof_from_ = 0; ///< frame from which proof_frames are counted
    std::int64_t settled_at_ = 0;
    std::int64_t muted_until_ = INT64_MIN;
    std::int64_t first_xrun_ = 0; ///< first of the xruns that count together
    unsigned xruns_ = 0;
};

} // namespace tactor::amplifier
