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

/// More than any PCM has.
inline constexpr unsigned max_pcm_channels = 1024;

struct alsa_options {
    std::string pcm = "null"; ///< any ALSA name
    unsigned channels = 0;    ///< exact, up to max_pcm_channels
    unsigned rate = 48000;    ///< exact, Hz; never resampled by us
    std::optional<format_kind> format =
        {};                      ///< none: the first of s32, float, s24_3, s24_4, s16 that it takes
    unsigned period_frames = 96; ///< wished, 50 us at least; the device may round it
    unsigned periods = 3;        ///< wished, >= 2
    /// ALSA configuration text in which `pcm` is looked up instead of the system's; empty: the system's.
    std::string config_text = {};
    /// Told of what was agreed on with the device, and of tries to open it again.
    log_function log = {};
};

/// Opens a PCM exactly as asked. Blocks shortly (ALSA reads its configuration).
/// \throws error: not_available when the PCM does not exist, is busy, may not be opened or cannot do
///         the whole set asked for (the message prints the set and what the device can do), bad_input
///         for numbers that no PCM can have and for configuration text that ALSA cannot read, runtime when
///         the process has no descriptors left. It keeps the PCM's own descriptors and one more.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> open_alsa(const alsa_options& o);

/// Opens a PCM that was lost once it is back: tries after 0.1 s, then after twice as long each time, up to
/// 5 s. `pause` waits for the time that it is given; it returns false to give up, because of a signal or a
/// deadline. Null when given up.
/// \throws error: what open_alsa() throws, but for not_available, which means not yet; bad_input without
/// `pause`.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> reopen_alsa(const alsa_options& o,
                                                           const std::function<bool(double pause_s)>& pause);

} // namespace v0
} // namespace tactor
