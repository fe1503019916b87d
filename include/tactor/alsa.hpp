// SPDX-License-Identifier: MIT
/// \file
/// ALSA playback as a sink, and the PCMs that could be played on.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/choices.hpp>
#include <tactor/error.hpp>
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

/// Stands for "as many as you like" in count_range::most, as software PCMs say.
inline constexpr unsigned no_limit = std::numeric_limits<unsigned>::max();

/// Whole numbers from least to most, both included.
struct count_range {
    unsigned least = 0;
    unsigned most = 0;
};

/// The abilities of a PCM. Each value counts by itself: on some devices not every combination works.
struct pcm_abilities {
    /// Channel counts, ascending, as ranges without gaps. A range that ends at 1024 may go on beyond.
    std::vector<count_range> channels = {};
    count_range rates_hz = {};
    std::vector<unsigned> usual_rates_hz = {}; ///< those of the usual rates, 8 to 768 kHz, that it takes
    std::vector<format_kind> formats = {};     ///< those that tactor can play, the preferred first
    count_range period_frames = {};
    count_range periods = {};
    count_range buffer_frames = {};
};

/// A process that has a playback device open.
struct process_info {
    int pid = 0;
    std::string program = {}; ///< empty: not told
};

/// A PCM for playback, by the name that alsa_options::pcm takes.
struct pcm_info {
    std::string name = {};        ///< a card's own device is hw:CARD=ID,DEV=N, whatever its number
    std::string description = {}; ///< of the card and device, or ALSA's own; one line; may be empty
    bool hardware = false;        ///< a card's own device, without conversion
    bool wanted = false;          ///< list_pcms() was asked about this one
    bool opened = false;
    /// The reason why it was not opened, and what to do. A PCM whose opening would empty a file or start a
    /// command is never tried here. One whose opening would start a card (mixers such as dmix do) or a sound
    /// server is tried only if it is the one that is wanted. open_alsa() tries them all.
    std::string error = {};
    bool tried = true;                      ///< false: see error
    std::vector<process_info> holders = {}; ///< who has a card's own device open
    std::optional<pcm_abilities> can = {};  ///< none where it was not opened
    std::string misfit = {}; ///< why it cannot play what is wanted; empty: it can, or not known
};

/// Lists the PCMs for playback: each device of each card, then those that ALSA's configuration names. They
/// are opened and looked at, not configured: nothing sounds and no other program is disturbed. With `wanted`
/// the list also says which of them take exactly its channels, rate and format, as open_alsa() would ask for;
/// its PCM is listed even where nothing else lists it. Blocks for some milliseconds. Any thread, but one at a
/// time.
/// \throws error: bad_input for numbers in `wanted` that no PCM can have; runtime, as all below, when the
///         process has no descriptors left. PCMs that cannot be opened say so in the list.
[[nodiscard]] TACTOR_API std::vector<pcm_info> list_pcms(const std::optional<alsa_options>& wanted = {});

/// The plugins between a PCM and its device, as ALSA's configuration says.
struct pcm_route {
    std::vector<std::string> types =
        {};                  ///< of its plugins, as they are defined: "plug", "hw"; none: not defined
    std::string server = {}; ///< the sound server in between: "PipeWire", "PulseAudio", "JACK"; empty: none
    bool writes = false;     ///< opening it empties a file or starts a command (type file)
};

/// Looks up the name of a PCM. Opens nothing, and does not throw for names that are not defined. Blocks for
/// some milliseconds (ALSA reads its configuration). Any thread, but one at a time.
[[nodiscard]] TACTOR_API pcm_route route_of(const std::string& pcm);

/// Tells which channels of the device a PCM would reach if it were opened with so many channels, as ALSA's
/// configuration says: through tables, bindings and everything else that hands channels on. As route_of(), it
/// blocks for some milliseconds, opens nothing, and does not throw for names that are not defined. Any
/// thread, but one at a time.
[[nodiscard]] TACTOR_API stream_wiring wiring_of(const std::string& pcm, unsigned channels);

/// Checks a name that somebody else has chosen, for example in an array file. This is needed because
/// open_alsa() takes any ALSA name, and one such as "file:'|COMMAND',raw" runs the command. A name passes if
/// it consists of letters, digits, "_", "-", and of ":", "," and "=" where ALSA's own names have them
/// ("hw:CARD=Tactor,DEV=0", "plug:'hw:0,1'"), and if ALSA's configuration defines it as a device: through
/// conversions, mixers and sound servers, but not through a file or a type that is not known here. A name
/// that is not defined passes, and cannot be opened. Blocks as route_of() does.
/// \throws error: bad_input that says what is wrong with the name.
TACTOR_API void require_device_name(const std::string& pcm);

/// A sound card.
struct card_info {
    unsigned index = 0;
    std::string id = {};   ///< as in hw:CARD=ID
    std::string name = {}; ///< for people
};

/// Finds the card that the name of a PCM refers to, as in "hw:CARD=Tactor" or "plughw:1,0"; nothing where
/// there is no such card. Blocks shortly (/proc). Any thread.
[[nodiscard]] TACTOR_API std::optional<card_info> card_of(const std::string& pcm);

/// Lists who has a playback device of this card open. Of other users' processes only those that the driver
/// tells of. Blocks shortly (/proc). Any thread.
[[nodiscard]] TACTOR_API std::vector<process_info> card_holders(unsigned card_index);

} // namespace v0
} // namespace tactor
