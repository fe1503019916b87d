// SPDX-License-Identifier: MIT
/// \file
/// What crosses the rings between the control side and the audio thread. Trivially copyable.
#pragma once

#include <cstdint>

#include <tactor/player.hpp>

#include "synth/score/event.hpp"

namespace tactor::engine {

class live_voice;

/// Scores that the audio thread can hold at once, sounding or about to; more wait on the control side.
inline constexpr std::uint32_t voices = 512;

/// Names one handing-over of a score to the audio thread: place in its table plus voices * generation. A
/// score that must be handed over again after an xrun gets a new ticket; commands that are still in the ring
/// under the old one are ignored.
using ticket = std::uint32_t;

constexpr std::uint32_t place_of(ticket t) noexcept
{
    return t % voices;
}

/// Control to audio, in order.
struct command {
    enum class kind : std::uint32_t { begin, drive, end, fail };
    kind what = kind::begin;
    ticket score = 0;
    stroke_id id = {}; ///< begin
    /// begin: frame of the stream; one that is over means now. fail: frame of the score where its drives end
    std::uint64_t at = 0;
    std::uint64_t length = 0;   ///< begin: frames
    synth::drive_event drive{}; ///< drive: frames from the start of the score, `score` is the ticket
};

/// Control to audio, past the commands that wait.
struct request {
    enum class kind : std::uint32_t { cancel, stop, live };
    kind what = kind::cancel;
    ticket score = 0;
    stroke_id id = {};           ///< live
    live_voice* voice = nullptr; ///< live: outlives the ticket
    bool closing = false;        ///< stop: the player is being closed; its strokes count as interrupted
};

/// Audio to control.
struct report {
    enum class kind : std::uint32_t {
        begun,       ///< `frame`: of the stream, where the score starts
        over,        ///< `frame`: frames of the score that were played
        returned,    ///< an xrun came before it had begun: hand it over again
        stream_over, ///< the last report of all
    };
    kind what = kind::begun;
    ticket score = 0;
    state_kind state = state_kind::finished;
    reason_kind why = reason_kind::none;
    int code = 0; ///< negative errno of the device
    std::uint64_t frame = 0;
    bool started = false;        ///< over: its first sample has been at the DAC ...
    std::int64_t started_ns = 0; ///< ... at this CLOCK_MONOTONIC
    live_delay delay = {};       ///< over: of a live stroke's points; 0 of them where there are none
};

} // namespace tactor::engine
