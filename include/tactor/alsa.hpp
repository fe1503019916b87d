// SPDX-License-Identifier: MIT
/// \file
/// ALSA playback as a sink, and the PCMs on which a program can play.
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

/// Upper bound of channel counts. No PCM has more.
inline constexpr unsigned max_pcm_channels = 1024;

/// Options to open a PCM.
struct alsa_options {
    std::string pcm = "null"; ///< any ALSA name
    unsigned channels = 0;    ///< channels of the stream, up to max_pcm_channels
    /// Wider stream. On: opens the PCM with its smallest channel count that is at least `channels`; the extra
    /// channels are silent. Off: opens it with exactly `channels`, or fails.
    bool wider = false;
    unsigned rate = 48000; ///< exact, Hz; the library never resamples
    /// Format; none: the first of s32, float, s24_3, s24_4, s16 that the PCM can do.
    std::optional<format_kind> format = {};
    unsigned period_frames = 96; ///< requested, 50 us at least; the device may round it
    unsigned periods = 3;        ///< requested, >= 2
    /// ALSA configuration text that defines `pcm`; empty: the system's configuration.
    std::string config_text = {};
    /// Receives messages about the negotiated stream and each attempt to open it again.
    log_function log = {};
};

/// Opens a PCM with exactly these options. Blocks shortly (each call reads ALSA's configuration as it is now,
/// and leaves libasound's own copy alone). The sink keeps the PCM's own descriptors and one more.
/// \throws error: not_available if the PCM does not exist, is busy, may not be opened or cannot do all that
///         was requested (the message prints the request and what the device can do), if ALSA cannot read its
///         configuration (the message has file and line), and for a definition on which libasound would end
///         the process; bad_input for numbers that no PCM can have, and for configuration text or a name's
///         arguments that ALSA cannot read; runtime when the process has no descriptors left.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> open_alsa(const alsa_options& o);

/// Waits until a lost PCM is back, and opens it. Tries after 0.1 s, then after twice as long each time, up to
/// 5 s. `pause` waits for the given time. If it returns false, because of a signal or a deadline, this gives
/// up and returns null.
/// \throws error: as open_alsa(), except not_available, which means that the PCM is not back yet; bad_input
///         without `pause`.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> reopen_alsa(const alsa_options& o,
                                                           const std::function<bool(double pause_s)>& pause);

/// Value of count_range::most that means "as many as you like". Software PCMs report it.
inline constexpr unsigned no_limit = std::numeric_limits<unsigned>::max();

/// Whole numbers from least to most, both included.
struct count_range {
    unsigned least = 0;
    unsigned most = 0;
};

/// Abilities of a PCM, each by itself: some devices cannot do every combination.
struct pcm_abilities {
    /// Channel counts, ascending, as ranges without gaps. A range that ends at 1024 may continue beyond.
    std::vector<count_range> channels = {};
    count_range rates_hz = {};
    std::vector<unsigned> usual_rates_hz = {}; ///< the usual rates, 8 to 768 kHz, that it can do
    std::vector<format_kind> formats = {};     ///< the formats that tactor can play, preferred first
    count_range period_frames = {};
    count_range periods = {};
    count_range buffer_frames = {};
};

/// A process that has a playback device open.
struct process_info {
    int pid = 0;
    std::string program = {}; ///< empty: not known
};

/// A PCM for playback, by the name that alsa_options::pcm takes.
struct pcm_info {
    std::string name = {};        ///< a card's own device is hw:CARD=ID,DEV=N, whatever its number
    std::string description = {}; ///< one line, from the card and device or from ALSA; may be empty
    bool hardware = false;        ///< a card's own device, without conversion
    bool wanted = false;          ///< the PCM that the caller of list_pcms() wants
    bool opened = false;
    /// Reason why it was not opened, and what to do. list_pcms() never tries a PCM that would empty a file or
    /// start a command. It tries one that would start a card (mixers such as dmix do) or a sound server only
    /// if the caller wants that one. open_alsa() tries them all.
    std::string error = {};
    bool tried = true;                      ///< false: see error
    std::vector<process_info> holders = {}; ///< processes that have a card's own device open
    std::optional<pcm_abilities> can = {};  ///< none if it was not opened
    std::string misfit = {}; ///< reason why it cannot play the wanted stream; empty: it can, or unknown
};

/// Lists the PCMs for playback: each device of each card, then those that ALSA's configuration names. Opens
/// them and reads their abilities, but does not configure them: nothing sounds and no other program is
/// disturbed.
///
/// With `wanted` the list also says which PCMs can do exactly its channels, rate and format, as open_alsa()
/// would request. The wanted PCM is in the list even if ALSA does not list it. Blocks for some milliseconds.
/// Any thread, but one at a time.
/// \throws error: bad_input for numbers in `wanted` that no PCM can have; runtime, here and in all functions
///         below, when the process has no descriptors left. For PCMs that cannot be opened, the list holds
///         the reason, also if ALSA cannot read its configuration.
[[nodiscard]] TACTOR_API std::vector<pcm_info> list_pcms(const std::optional<alsa_options>& wanted = {});

/// Plugins between a PCM and its device, from ALSA's configuration.
struct pcm_route {
    std::vector<std::string> types = {}; ///< type of each plugin: "plug", "hw"; empty: the PCM is not defined
    std::string server = {}; ///< sound server on the route: "PipeWire", "PulseAudio", "JACK"; empty: none
    bool writes = false;     ///< opening it empties a file or starts a command (type file)
};

/// Looks up the name of a PCM. Opens nothing, and does not throw for names that are not defined. Blocks for
/// some milliseconds (ALSA reads its configuration). Any thread, but one at a time.
[[nodiscard]] TACTOR_API pcm_route read_route(const std::string& pcm);

/// Returns the channels of the device that a PCM reaches if it is opened with `channels` channels. Reads
/// ALSA's configuration and follows tables, bindings and everything else that passes channels on. Blocks for
/// some milliseconds, opens nothing, and does not throw for names that are not defined. Any thread, but one
/// at a time.
/// \throws error (not_available) if ALSA cannot read its configuration.
[[nodiscard]] TACTOR_API stream_wiring read_wiring(const std::string& pcm, unsigned channels);

/// Checks the name of a PCM that somebody else has chosen, for example in an array file. Such names are
/// dangerous: open_alsa() takes any ALSA name, and "file:'|COMMAND',raw" runs the command.
///
/// A name passes if it has only letters, digits, "_", "-", and ":", "," and "=" where ALSA's own names have
/// them ("hw:CARD=Tactor,DEV=0", "plug:'hw:0,1'"), and if ALSA's configuration defines it as a device. The
/// route may go through conversions, mixers and sound servers, but not through a file or an unknown type. A
/// name that is not defined passes, and cannot be opened. Blocks as read_route() does.
/// \throws error (bad_input) that says what is wrong with the name.
TACTOR_API void require_device_name(const std::string& pcm);

/// A sound card.
struct card_info {
    unsigned index = 0;
    std::string id = {};   ///< as in hw:CARD=ID
    std::string name = {}; ///< for people
};

/// Finds the card to which the name of a PCM refers, as in "hw:CARD=Tactor" or "plughw:1,0". Returns nothing
/// if there is no such card. Blocks shortly (/proc). Any thread.
[[nodiscard]] TACTOR_API std::optional<card_info> read_card(const std::string& pcm);

/// Lists the processes that have a playback device of this card open. Of other users' processes it lists only
/// those that the driver reports. Blocks shortly (/proc). Any thread.
[[nodiscard]] TACTOR_API std::vector<process_info> card_holders(unsigned card_index);

} // namespace v0
} // namespace tactor
