// SPDX-License-Identifier: MIT
/// \file
/// Messages in the rings between the control side and the audio thread. Trivially copyable.
#pragma once

#include <cstdint>

#include <tactor/player.hpp>

#include "synth/score/event.hpp"

namespace tactor::engine {

class live_voice;

/// Most scores that the audio thread holds at once, sounding or about to; more wait on the control side.
inline constexpr std::uint32_t voices = 512;

/// Identifier of one handing-over of a score to the audio thread: place in its table plus voices *
/// generation. A score that must be handed over again after an xrun gets a new ticket. Commands under the old
/// one that are still in the ring are ignored.
using ticket = std::uint32_t;

constexpr std::uint32_t ticket_place(ticket t) noexcept
{
    return t % voices;
}

/// Message from control to audio, in order.
struct command {
    enum class kind : std::uint32_t { begin, drive, end };
    kind what = kind::begin;
    ticket score = 0;
    stroke_id id = {};          ///< begin
    std::uint64_t at = 0;       ///< begin: frame of the stream; a past one means now
    std::uint64_t length = 0;   ///< begin: frames
    synth::drive_event drive{}; ///< drive: frames count from the start of the score; `score` is the ticket
};

/// Message from control to audio that overtakes waiting commands.
struct request {
    enum class kind : std::uint32_t { cancel, stop, live };
    kind what = kind::cancel;
    ticket score = 0;
    stroke_id id = {};           ///< live
    live_voice* voice = nullptr; ///< live: outlives the ticket
    bool closing = false;        ///< stop: the player closes, so its strokes count as interrupted
};

/// Message from audio to control.
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
    live_delay delay = {};       ///< over: delays of a live stroke's points; 0 points if there are none
};

} // namespace tactor::engine
