// SPDX-License-Identifier: MIT
/// \file
/// Explanations and hints for ALSA's error numbers, and libasound's own messages, which go into errors
/// instead of to standard error.
///
/// libasound has one message handler for the process, which belongs to the host program. The default one
/// passes messages to a handler of each thread. That one is replaced during the calls, and then restored.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <alsa/asoundlib.h>

#include <tactor/error.hpp>

#include "sink/alsa/devices.hpp"

namespace tactor::alsa {

/// Calls snd_lib_error_set_local(), which alsa-lib 1.2.8 declares without extern "C".
snd_local_error_handler_t set_local_handler(snd_local_error_handler_t h) __asm__("snd_lib_error_set_local");

/// Silence of libasound on this thread while the object lives, unless the host has its own handler. The audio
/// thread uses it: no lock and no allocation.
class quiet {
public:
    quiet() noexcept : quiet(&ignore) {}
    ~quiet() { set_local_handler(before_); }
    quiet(const quiet&) = delete;
    quiet& operator=(const quiet&) = delete;

protected:
    explicit quiet(snd_local_error_handler_t h) noexcept : before_(set_local_handler(h)) {}

private:
    static void ignore(const char*, int, const char*, int, const char*, va_list) noexcept {}

    snd_local_error_handler_t before_;
};

/// Collector of libasound's messages on this thread while it lives. A second one takes the messages while
/// that lives.
class library_messages : quiet {
public:
    library_messages() noexcept;
    ~library_messages();
    library_messages(const library_messages&) = delete;
    library_messages& operator=(const library_messages&) = delete;

    /// Returns the first message since construction, or nothing. Always nothing if the host has its own
    /// handler.
    std::string first() const;
    /// Returns the messages, a line each, as far as they fit in 1000 bytes.
    std::string all() const;

private:
    [[gnu::format(printf, 5, 0)]] static void collect(const char*, int, const char*, int, const char* format,
                                                      va_list arguments) noexcept;

    std::array<char, 1000> text_{};
    std::size_t length_ = 0;
    library_messages* outer_;
};

/// Returns "text: detail", or "text" without a detail.
std::string with_detail(const std::string& text, const std::string& detail);

/// The system around a PCM that cannot be opened.
struct surroundings {
    std::vector<std::string> pcms = {}; ///< names that the configuration defines
    system_root root = "/";
    std::vector<std::string> route = {}; ///< types of the plugins on the name's route
    bool bad_arguments = false;          ///< the name's definition does not take the text after its colon
};

/// Returns why a PCM could not be opened (negative errno) and what to do. `detail`: libasound's own words.
error open_error(const std::string& name, int code, const std::string& detail, const surroundings& s = {});

/// Returns the error of a call that should have succeeded.
error call_error(const std::string& name, const char* call, int code);

} // namespace tactor::alsa
