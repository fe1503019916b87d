// SPDX-License-Identifier: MIT
#include "alsa/library_messages.hpp"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>

#include <alsa/asoundlib.h>

namespace tactor::pcm {
namespace {

// A plain array: the handler must work in the audio thread too, where nobody listens.
thread_local bool listening = false;
thread_local std::array<char, 200> text{};

extern "C" [[gnu::format(printf, 5, 6)]] void collect(const char*, int, const char*, int, const char* format,
                                                      ...)
{
    if (!listening || text[0] != '\0')
        return;
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text.data(), text.size(), format, arguments);
    va_end(arguments);
}

} // namespace

library_messages::library_messages()
{
    static std::once_flag once;
    std::call_once(once, [] { snd_lib_error_set_handler(collect); });
    text[0] = '\0';
    listening = true;
}

library_messages::~library_messages()
{
    listening = false;
}

std::string library_messages::first() const
{
    std::string s(text.data());
    while (!s.empty() && (s.back() == '\n' || s.back() == ' '))
        s.pop_back();
    return s;
}

} // namespace tactor::pcm
