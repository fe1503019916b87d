// SPDX-License-Identifier: MIT
/// \file
/// The PCMs that could be played on and what each can do. GPIO chips and lines: list_gpio() in gpio.hpp.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <tactor/alsa.hpp>
#include <tactor/api.hpp>
#include <tactor/sample_format.hpp>
#include <tactor/sink.hpp>

namespace tactor {
inline namespace v0 {

/// Stands for "as many as you like" in count_range::most, as software PCMs say.
inline constexpr unsigned no_limit = std::numeric_limits<unsigned>::max();

/// Whole numbers from least to most, both included.
struct count_range {
    unsigned least = 0;
    unsigned most = 0;
};

/// What a PCM takes. Each alone: on some devices not every combination works.
struct pcm_abilities {
    /// Channel counts, ascending, as ranges without gaps; one that reaches 1024 may go on.
    std::vector<count_range> channels = {};
    count_range rates_hz = {};
    std::vector<unsigned> usual_rates_hz = {}; ///< of the rates in use from 8 to 768 kHz those it takes
    std::vector<format_kind> formats = {};     ///< of those that tactor plays, the preferred first
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
    bool wanted = false;          ///< the one that was asked about
    bool opened = false;
    /// Why it was not opened, and what to do. Not tried are PCMs whose opening would start a card, as mixers
    /// (dmix) do, or a sound server, but for the one that is wanted; and none that would empty a file or
    /// start a command. open_alsa() tries.
    std::string error = {};
    bool tried = true;                      ///< false: see error
    std::vector<process_info> holders = {}; ///< who has a card's own device open
    std::optional<pcm_abilities> can = {};  ///< none where it was not opened
    std::string misfit = {}; ///< why it cannot play what is wanted; empty: it can, or not known
};

/// All PCMs for playback: each device of each card, then what ALSA's configuration names. Those are opened
/// and looked at, not configured: nothing sounds and no other program is disturbed. `wanted`: also says
/// which of them take exactly its channels, rate and format, as open_alsa() would ask for; its PCM is listed
/// even where nothing else lists it.
/// Blocks for some milliseconds. Any thread, but one at a time.
/// \throws error: bad_input for numbers in `wanted` that no PCM can have. PCMs that cannot be opened say so
///         in the list.
[[nodiscard]] TACTOR_API std::vector<pcm_info> list_pcms(const std::optional<alsa_options>& wanted = {});

/// What playing on a PCM goes through, as ALSA's configuration says.
struct pcm_route {
    std::vector<std::string> types =
        {};                  ///< of its plugins, as they are defined: "plug", "hw"; none: not defined
    std::string server = {}; ///< the sound server in between: "PipeWire", "PulseAudio", "JACK"; empty: none
    bool writes = false;     ///< opening it empties a file or starts a command (type file)
};

/// Looks the name of a PCM up. Nothing is opened, and nothing thrown for names that nobody defines. Blocks
/// for some milliseconds (ALSA reads its configuration). Any thread, but one at a time.
[[nodiscard]] TACTOR_API pcm_route route_of(const std::string& pcm);

/// Which channels of the device so many channels of a PCM would reach, as ALSA's configuration says: through
/// tables, bindings and whatever hands channels on. Blocks as route_of() does, opens and throws no more than
/// it. Any thread, but one at a time.
[[nodiscard]] TACTOR_API stream_wiring wiring_of(const std::string& pcm, unsigned channels);

/// For names that others have chosen, as in an array file that they made: open_alsa() takes any ALSA name,
/// and one such as "file:'|COMMAND',raw" runs the command. Passes letters, digits, "_", "-", and ":", "," and
/// "=" where ALSA's own names have them ("hw:CARD=Tactor,DEV=0", "plug:'hw:0,1'"), if ALSA's configuration
/// defines the name as a device: through conversions, mixers and sound servers, but no file, and nothing that
/// it does not know. Names that nobody defines pass, and cannot be opened. Blocks as route_of() does. \throws
/// error: bad_input that says what is wrong with the name.
TACTOR_API void require_device_name(const std::string& pcm);

/// A sound card.
struct card_info {
    unsigned index = 0;
    std::string id = {};   ///< as in hw:CARD=ID
    std::string name = {}; ///< for people
};

/// The card that the name of a PCM says, as in "hw:CARD=Tactor" or "plughw:1,0", where there is such a card.
/// Blocks shortly (/proc). Any thread.
[[nodiscard]] TACTOR_API std::optional<card_info> card_of(const std::string& pcm);

/// Who has a playback device of this card open; of other users' processes only what the driver tells.
/// Blocks shortly (/proc). Any thread.
[[nodiscard]] TACTOR_API std::vector<process_info> card_holders(unsigned card_index);

} // namespace v0
} // namespace tactor
