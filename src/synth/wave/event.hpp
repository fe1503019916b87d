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

/// Drive of a channel: the peak amplitude (level, gain and polarity included) at the first frame of the event
/// and at the frame after its last, linear between.
struct channel_drive {
    double from;
    double to;
    std::uint32_t channel;
};

inline constexpr unsigned points_per_line = 9;

/// Drive of a channel with bends: its peak amplitude at some frames of the event, linear between them.
struct channel_line {
    std::array<double, points_per_line> amplitude;
    std::array<std::uint16_t, points_per_line> frame; ///< frames since the event's start, up to its length
    std::uint32_t channel;
};

/// Drives of up to four channels, or of one channel with bends, that share one carrier from frame `start` for
/// `length` frames. The signal at frame start + j is
///     amplitude(j) * w(ramp_position + j) * sin(2 pi cycles_per_frame (phase_frame + j))
/// where w is the window of `window` frames that rises in `ramp` and falls in `release` frames. If
/// cycles_per_frame is 0, the sine is 1: the event is a marker, which sounds only on a channel without a
/// tactor. (Own samples on such a channel have cycles_per_frame 0, too.) A timbre replaces the sine. Parts of
/// a timbre that continue through the stroke, whatever the carrier's phase, are at frame phase_origin +
/// phase_frame + j.
struct drive_event {
    std::uint64_t start = 0;         ///< frames since the start of the score (source) or of the epoch (mixer)
    std::uint64_t phase_frame = 0;   ///< carrier frame at `start`
    std::uint64_t phase_origin = 0;  ///< timbre only: the stroke's frame at which its phase begins
    double cycles_per_frame = 0.0;   ///< carrier / rate
    std::uint64_t ramp_position = 0; ///< place of `start` in the window
    std::uint64_t window = 0;        ///< frames of the whole burst (or of the continuous stroke)
    std::uint32_t ramp = 0;          ///< frames in which the window rises; 0: no ramp
    std::uint32_t release = as_ramp; ///< frames in which the window falls
    std::uint32_t length = 0;        ///< frames
    envelope_kind shape = envelope_kind::raised_cosine;
    std::uint32_t score = 0;  ///< submitted score to which it belongs
    std::uint32_t drives = 0; ///< number of used elements of `drive`
    std::uint32_t points =
        0; ///< number of used elements of `line`, which replaces `drive`; 0: `drive` counts
    const timbre* sound = nullptr; ///< null for a sine; must live until the score is over
    union {
        std::array<channel_drive, drives_per_event> drive{};
        channel_line line;
    };
};
static_assert(std::is_trivially_copyable_v<drive_event>);

} // namespace tactor::synth
