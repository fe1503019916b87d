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

/// Upper bound of channel counts. No PCM has more channels.
inline constexpr unsigned max_pcm_channels = 1024;

/// Options to open a PCM.
struct alsa_options {
    std::string pcm = "null"; ///< any ALSA name
    unsigned channels = 0;    ///< channels of the stream, up to max_pcm_channels
    /// Permission to use more channels than `channels`. True: open_alsa() opens the PCM with its smallest
    /// channel count that is not below `channels`, and the extra channels are silent. False: open_alsa()
    /// opens the PCM with exactly `channels`, or fails.
    bool wider = false;
    unsigned rate = 48000; ///< Hz, used exactly: the library never resamples
    /// Sample format. None: the first of s32, float, s24_3, s24_4 and s16 that the PCM supports.
    std::optional<format_kind> format = {};
    unsigned period_frames = 96; ///< requested, at least 50 us; the device may round the number
    unsigned periods = 3;        ///< requested, >= 2
    /// ALSA configuration text that defines `pcm`; empty: the system's configuration.
    std::string config_text = {};
    /// Receives messages about the negotiated stream and each attempt to reopen the PCM.
    log_function log = {};
};

/// Opens a PCM with exactly these options. Blocks shortly. Each call reads ALSA's present configuration and
/// does not change the copy that libasound keeps. The sink uses the PCM's descriptors and one more.
/// \throws error (not_available) if the PCM does not exist, is busy, may not be opened or does not support
///         the request. The message prints the request and what the device supports.
/// \throws error (not_available) if ALSA cannot read its configuration (the message has file and line), or if
///         libasound would end the process because of the PCM's definition.
/// \throws error (bad_input) for numbers that no PCM can have, and if ALSA cannot read the configuration text
///         or the arguments in the name.
/// \throws error (runtime) if the process has no descriptors left.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> open_alsa(const alsa_options& o);

/// Waits until a lost PCM is back, and opens it. Tries first after 0.1 s. Each further pause is twice as long
/// as the last pause, up to 5 s. `pause` waits for the given time. If `pause` returns false, because of a
/// signal or a deadline, reopen_alsa() gives up and returns null.
/// \throws error as open_alsa() does, but not error (not_available), which means that the PCM is not back
///         yet.
/// \throws error (bad_input) if `pause` is empty.
[[nodiscard]] TACTOR_API std::unique_ptr<sink> reopen_alsa(const alsa_options& o,
                                                           const std::function<bool(double pause_s)>& pause);

/// Value of count_range::most that means "no limit". Software PCMs report this value.
inline constexpr unsigned no_limit = std::numeric_limits<unsigned>::max();

/// Whole numbers from least to most, both included.
struct count_range {
    unsigned least = 0;
    unsigned most = 0;
};

/// Abilities of a PCM, each considered alone: some devices do not support every combination.
struct pcm_abilities {
    /// Channel counts, ascending, as ranges without gaps. Counts above max_pcm_channels are not tested.
    std::vector<count_range> channels = {};
    count_range rates_hz = {};
    std::vector<unsigned> usual_rates_hz = {}; ///< supported rates, of the usual ones from 8 to 768 kHz
    std::vector<format_kind> formats = {};     ///< supported formats that tactor can play, preferred first
    count_range period_frames = {};
    count_range periods = {};
    count_range buffer_frames = {};
};

/// A process that has a playback device open.
struct process_info {
    int pid = 0;
    std::string program = {}; ///< empty: not known
};

/// A PCM for playback.
struct pcm_info {
    /// Name as in alsa_options::pcm. A card's own device is hw:CARD=ID,DEV=N, whatever the card's number is.
    std::string name = {};
    std::string description = {}; ///< one line, from the card and device or from ALSA; may be empty
    bool hardware = false;        ///< a card's own device, without conversion
    std::string preset = {};      ///< name of the built-in array for this kind of card; empty: none
    bool wanted = false;          ///< the PCM that the caller of list_pcms() wants
    bool opened = false;
    /// Reason why list_pcms() did not open this PCM, and what to do. list_pcms() never tries a PCM that would
    /// empty a file or start a command. Some PCMs start a card (mixers such as dmix) or a sound server when
    /// they are opened: list_pcms() tries such a PCM only if the caller wants it. open_alsa() tries all PCMs.
    std::string error = {};
    bool tried = true;                      ///< false: list_pcms() did not try to open it, see error
    std::vector<process_info> holders = {}; ///< processes that have a card's own device open
    std::optional<pcm_abilities> can = {};  ///< none if the PCM was not opened
    std::string misfit = {}; ///< reason why the PCM cannot play the wanted stream; empty: none is known
};

/// Lists the PCMs for playback: each device of each card, then the PCMs that ALSA's configuration names.
/// Opens them and reads their abilities, but does not configure them. So nothing sounds, and no other program
/// is disturbed.
///
/// With `wanted`, the list also says which PCMs support exactly the channels, rate and format of `wanted`, as
/// open_alsa() would request them. If neither a card nor the configuration lists the wanted PCM, the function
/// adds that PCM. If a PCM cannot be opened, the list gives the reason, even if ALSA cannot read its
/// configuration. Blocks for some milliseconds. Any thread may call this, but only one at a time.
/// \throws error (bad_input) for numbers in `wanted` that no PCM can have.
/// \throws error (runtime) if the process has no descriptors left; so do all functions below.
[[nodiscard]] TACTOR_API std::vector<pcm_info> list_pcms(const std::optional<alsa_options>& wanted = {});

/// Plugins between a PCM and its device, from ALSA's configuration.
struct pcm_route {
    std::vector<std::string> types = {}; ///< plugin types ("plug", "hw"); empty: the PCM is not defined
    std::string server = {}; ///< sound server on the route: "PipeWire", "PulseAudio", "JACK"; empty: none
    bool writes = false;     ///< opening the PCM empties a file or starts a command (type file)
};

/// Looks up the route of a PCM by the PCM's name. Opens nothing. Does not throw for names that are not
/// defined. Blocks for some milliseconds while ALSA reads its configuration. Any thread may call this, but
/// only one at a time.
[[nodiscard]] TACTOR_API pcm_route read_route(const std::string& pcm);

/// Returns the channels of the device that a PCM reaches if a program opens the PCM with `channels` channels.
/// Reads ALSA's configuration and follows tables, bindings and everything else that routes channels. Opens
/// nothing. Does not throw for names that are not defined. Blocks for some milliseconds. Any thread may call
/// this, but only one at a time.
/// \throws error (not_available) if ALSA cannot read its configuration.
[[nodiscard]] TACTOR_API stream_wiring read_wiring(const std::string& pcm, unsigned channels);

/// Checks the name of a PCM that somebody else has chosen, for example in an array file. Such names are
/// dangerous: open_alsa() accepts any ALSA name, and the name "file:'|COMMAND',raw" runs the command.
///
/// A name passes if both of these are true:
/// - The name has only letters, digits, "_" and "-", and ":", "," and "=" where ALSA's own names have these
///   characters ("hw:CARD=Tactor,DEV=0", "plug:'hw:0,1'").
/// - ALSA's configuration defines the name as a device whose route may contain conversions, mixers and sound
///   servers, but no file and no unknown type.
///
/// A name that is not defined passes, too: it cannot be opened. Blocks as read_route() does.
/// \throws error (bad_input) that says what is wrong with the name.
TACTOR_API void require_device_name(const std::string& pcm);

/// A sound card.
struct card_info {
    unsigned index = 0;
    std::string id = {};   ///< as in hw:CARD=ID
    std::string name = {}; ///< for people
};

/// Finds the card to which the name of a PCM refers, such as "hw:CARD=Tactor" or "plughw:1,0". Returns
/// nothing if there is no such card. Blocks shortly while it reads /proc. Any thread.
[[nodiscard]] TACTOR_API std::optional<card_info> read_card(const std::string& pcm);

/// Lists the processes that have a playback device of this card open. Lists a process of another user only if
/// the driver reports it. Blocks shortly while it reads /proc. Any thread.
[[nodiscard]] TACTOR_API std::vector<process_info> card_holders(unsigned card_index);

} // namespace v0
} // namespace tactor
