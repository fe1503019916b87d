// SPDX-License-Identifier: MIT
/// \file
/// The PCM on which a session plays: its name, how to open it, its limits, and sound servers in between. Also
/// the list of all devices.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <tactor/alsa.hpp>
#include <tactor/array.hpp>
#include <tactor/sink.hpp>
#include <tactor/tactor.hpp>

#include "desktop/desktop.hpp"
#include "session/environment.hpp"

namespace tactor::session {

/// Returns true if an option or a file names the PCM.
bool has_configured_pcm(const settings& s, const environment& e);

/// Prints on standard error that the session plays to "null", if nothing names the PCM.
void report_missing_device(const settings& s, const environment& e);

/// Returns the options that open the PCM with `channels` channels at `rate` Hz. The PCM is "null" if nothing
/// names one. \throws error (bad_input) if the PCM of an array file is more than the name of a device.
alsa_options device_options(const settings& s, const stream_options& chosen, const environment& e,
                            unsigned channels, unsigned rate);

/// Returns `l`, but with the limits that the options set.
drive_limits override_limits(const stream_options& chosen, drive_limits l);

/// Returns the limits from the options, from [limits] or from the defaults, in this order.
drive_limits find_limits(const stream_options& o, const environment& e);

/// Returns a warning if the latency of the device exceeds `limit_ms`, else an empty string.
std::string latency_warning(std::optional<double> limit_ms, const stream_setup& made);

/// Returns the duration of a full buffer, ms.
double latency_ms(const stream_setup& s);

/// Returns a hint for a PCM with fewer channels than `o` requests. If `a` fits, the hint names the channel
/// that a marker or a plan adds. Otherwise the hint names the largest built-in array that fits. Empty if
/// there is no hint.
std::string find_fit(alsa_options o, const array& a);

/// Allows this process to ask RealtimeKit for the priority of its threads, or forbids it (`no_desktop`).
void configure_realtime_kit(const stream_options& o) noexcept;

/// A card that a sound server has released to a session. Other programs may ask for it.
struct card_claim {
    bool ask = true;                  ///< ask for a busy card; if false, a busy card is an error
    std::atomic<bool> idle = false;   ///< no stroke needs the card, so another program may have it
    std::atomic<bool> wanted = false; ///< another program was promised that the card is closed soon
    std::function<void()> news = {};  ///< called in another thread after `wanted` is set
    std::string holder = {};          ///< program that gave the card up; empty if the card was not busy
    std::unique_ptr<desktop::reservation> reserved = {}; ///< to be reset once the device is closed
};

/// Opens a device on a card by `open`. If the card is busy, asks the program that holds it to give it up, and
/// tries again. Blocks for some seconds at most.
/// \throws exceptions of `open`; if the program refuses, the hint says so.
std::unique_ptr<sink> open_on_card(const std::function<std::unique_ptr<sink>()>& open, unsigned card_index,
                                   card_claim& c);

/// Opens a PCM for an array, like open_alsa() and open_on_card(). If the PCM has too few channels, the hint
/// names an array that fits.
std::unique_ptr<sink> open_device(const alsa_options& o, const array& a, card_claim& c);

/// Returns the sound server between this process and a PCM; empty if there is none. For PipeWire, sets the
/// variable PIPEWIRE_ALSA of this process unless it is set, so that each channel goes unmixed to the output
/// with its number. Call it before threads start and before the PCM is opened.
std::string prepare_server(const std::string& pcm);

/// Hint for a sound server between this process and the card.
inline constexpr const char* server_cure = "use -D hw:CARD=NAME to play on the card itself";

/// Warns on standard error of a sound server in between, if any.
void warn_of_server(const std::string& server, const char* cure = server_cure);

/// Returns true if output on a PCM may be felt. Output that goes only to PCMs of type null is not felt.
bool is_felt(const std::string& pcm);

/// Returns the effects that a server in between may have.
std::string server_note(const std::string& server);

/// A remark about a possible effect on the stream, and a hint.
struct device_note {
    std::string text;
    const char* cure;
};

/// Lists notes about the routes of the stream's channels: routes that change levels by ALSA's configuration,
/// and unknown routes. server_note() describes routes through a sound server.
std::vector<device_note> wiring_notes(const array& a, const stream_setup& s);

/// Existing devices, and the options with which play would open one.
struct device_list {
    std::string array_name;
    alsa_options wanted;            ///< options with which play would open a device
    bool pcm_is_configured = false; ///< the user or a file named the PCM; if false, `wanted` has the default
    std::vector<pcm_info> pcms;
    std::vector<gpio_chip_info> chips;
};

/// Examines all devices, and whether they fit the settings.
/// \throws error.
device_list examine_devices(const settings& s, const environment& e);

/// Returns the list as a JSON object of schema tactor-devices/1.
std::string devices_json(const device_list& d);
/// Returns the JSON schema of that object.
nlohmann::ordered_json devices_schema();

} // namespace tactor::session
