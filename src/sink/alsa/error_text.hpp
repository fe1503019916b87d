// SPDX-License-Identifier: MIT
/// \file
/// Explanations and hints for ALSA's error numbers, and libasound's own messages, which go into errors
/// instead of to standard error.
///
/// libasound has one message handler for the process, which belongs to the host program. The default handler
/// passes messages to a handler of the current thread. tactor replaces the handler of the thread during its
/// calls, and then restores it.
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

/// Scope in which libasound prints nothing on this thread, unless the host has its own handler. Does not lock
/// or allocate, because the audio thread uses it.
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

/// Scope in which libasound's messages on this thread are collected. If objects are nested, the innermost one
/// gets the messages.
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
std::string append_detail(const std::string& text, const std::string& detail);

/// Facts about the system that explain why a PCM cannot be opened.
struct surroundings {
    std::vector<std::string> pcms = {}; ///< names that the configuration defines
    system_root root = "/";
    std::vector<std::string> route = {}; ///< types of the plugins on the name's route
    bool bad_arguments = false;          ///< the definition does not accept the text after the name's colon
};

/// Returns an error that says why a PCM could not be opened, and what to do. `code`: negative errno.
/// `detail`: message of libasound.
error open_error(const std::string& name, int code, const std::string& detail, const surroundings& s = {});

/// Returns the error of a call that should have succeeded.
error call_error(const std::string& name, const char* call, int code);

} // namespace tactor::alsa
