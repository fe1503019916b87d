// SPDX-License-Identifier: MIT
/// \file
/// Elements of the ring from the control side to the audio thread: scheduled drives, not audio.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include <tactor/render.hpp>

namespace tactor::synth {

struct timbre;

/// Value of drive_event::release that means "the same as `ramp`".
inline constexpr std::uint32_t as_ramp = ~std::uint32_t{0};

inline constexpr unsigned drives_per_event = 4;

/// Part of a channel: peak amplitude (level, gain and polarity included) at the first frame of the event and
/// at the frame after its last; linear between.
struct channel_drive {
    double from;
    double to;
    std::uint32_t channel;
};

inline constexpr unsigned points_per_line = 9;

/// Part of a channel with bends: its peak amplitude at some frames of the event, linear between them.
struct channel_line {
    std::array<double, points_per_line> amplitude;
    std::array<std::uint16_t, points_per_line> frame; ///< since the event's start: 0, ascending, its length
    std::uint32_t channel;
};

/// Up to four channels, or one with bends, that share one carrier from frame `start` for `length` frames. The
/// signal at frame start + j is
///     amplitude(j) * w(ramp_position + j) * sin(2 pi cycles_per_frame (phase_frame + j))
/// (1 in place of the sine where cycles_per_frame is 0: a marker, which only a channel without a tactor
/// takes; samples of one's own there have no cycles either) with w the window of `window` frames that rises
/// in `ramp` and falls in `release`. A timbre stands in for the sine; what of it goes on through the stroke,
/// whatever the carrier's phase does, is at frame phase_origin + phase_frame + j.
struct drive_event {
    std::uint64_t start = 0;         ///< frames since the start of the score (source) or of the epoch (mixer)
    std::uint64_t phase_frame = 0;   ///< carrier frame at `start`
    std::uint64_t phase_origin = 0;  ///< timbre only: the stroke's frame at which its phase begins
    double cycles_per_frame = 0.0;   ///< carrier / rate
    std::uint64_t ramp_position = 0; ///< place of `start` in the window
    std::uint64_t window = 0;        ///< frames of the whole burst (or of the continuous stroke)
    std::uint32_t ramp = 0;          ///< 0: none
    std::uint32_t release = as_ramp; ///< frames in which the window falls
    std::uint32_t length = 0;        ///< frames
    envelope_kind shape = envelope_kind::raised_cosine;
    std::uint32_t score = 0;  ///< submitted score to which it belongs
    std::uint32_t drives = 0; ///< number of used elements of `drive`
    std::uint32_t points =
        0; ///< number of used elements of `line`, which replaces `drive`; 0: `drive` counts
    const timbre* sound = nullptr; ///< lives until the score is over; null: a sine
    union {
        std::array<channel_drive, drives_per_event> drive{};
        channel_line line;
    };
};
static_assert(std::is_trivially_copyable_v<drive_event>);

} // namespace tactor::synth
