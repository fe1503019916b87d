// SPDX-License-Identifier: MIT
/// \file
/// ALSA playback as a sink.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <tactor/api.hpp>
#include <tactor/log.hpp>
#include <tactor/sink.hpp>

namespace tactor {
inline namespace v0 {

/// Upper bound of channel counts: more than any PCM has.
inline constexpr unsigned max_pcm_channels = 1024;

struct alsa_options {
    std::string pcm = "null"; ///< any ALSA name
    unsigned channels = 0;    ///< of the stream, up to max_pcm_channels
    /// Takes the fewest channels that the PCM can do and that hold `channels`; the others are silent. Off:
    /// the PCM is opened with `channels`, or not at all.
    bool wider = false;
    unsigned rate = 48000; ///< exact, Hz; the library never resamples
    std::optional<format_kind> format =
        {};                      ///< none: the first of s32, float, s24_3, s24_4, s16 that the PCM takes
    unsigned period_frames = 96; ///< requested, 50 us at least; the device may round it
    unsigned periods = 3;        ///< requested, >= 2
    /// ALSA configuration text in which `pcm` is looked up; empty: the system's configuration.
    std::string config_text = {};
    /// Is told of what was agreed on with the device, and of each attempt to open it again.
    log_function log = {};
};

/// Opens a PCM exactly as asked. Blocks shortly (ALSA reads its configuration). The sink keeps the PCM's own
/// descriptors and one more.
/// \throws error: not_available when the PCM does not exist, is busy, may not be opened or cannot do the
///         whole set asked for (the message prints the set and what the device can do), bad_input for numbers
///         that no PCM can have and for configuration text that ALSA cannot read, runtime when the process
///         has no descriptors left.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> open_alsa(const alsa_options& o);

/// Waits until a lost PCM is back, and opens it: tries after 0.1 s, then after twice as long each time, up to
/// 5 s. `pause` waits for the time that it is given. It returns false to give up, because of a signal or a
/// deadline; the result is null then.
/// \throws error: what open_alsa() throws, except not_available, which means that the PCM is not back yet;
///         bad_input without `pause`.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> reopen_alsa(const alsa_options& o,
                                                           const std::function<bool(double pause_s)>& pause);

} // namespace v0
} // namespace tactor
