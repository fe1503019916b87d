// SPDX-License-Identifier: MIT
/// \file
/// What libasound has to say, for error messages instead of the user's standard error.
///
/// libasound has one handler of messages for the process, which is the host program's business, and in its
/// default one a handler for each thread: that is taken for as long as the calls take, and put back.
#pragma once

#include <array>
#include <string>

#include <alsa/asoundlib.h>

namespace tactor::pcm {

/// snd_lib_error_set_local(), which alsa-lib 1.2.8 declares to C++ as if it were written in it.
snd_local_error_handler_t set_local_handler(snd_local_error_handler_t h) __asm__("snd_lib_error_set_local");

/// Silences libasound on this thread while it lives, unless the host has a handler of its own. No lock and no
/// allocation: the audio thread uses it.
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

/// Collects libasound's first message of this thread while it lives. What it says within the life of a second
/// one is that one's.
class library_messages : quiet {
public:
    library_messages() noexcept;
    ~library_messages();
    library_messages(const library_messages&) = delete;
    library_messages& operator=(const library_messages&) = delete;

    /// The first message since construction, or nothing; nothing either where the host has its own handler.
    std::string first() const;

private:
    [[gnu::format(printf, 5, 0)]] static void collect(const char*, int, const char*, int, const char* format,
                                                      va_list arguments) noexcept;

    std::array<char, 200> text_{};
    library_messages* outer_;
};

} // namespace tactor::pcm
