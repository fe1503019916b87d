// SPDX-License-Identifier: MIT
#include "sink/alsa/library_messages.hpp"

#include <cstdarg>
#include <cstdio>
#include <utility>

namespace tactor::alsa {
namespace {

thread_local library_messages* innermost = nullptr;

} // namespace

library_messages::library_messages() noexcept : quiet(&collect), outer_(std::exchange(innermost, this))
{
}

library_messages::~library_messages()
{
    innermost = outer_;
}

void library_messages::collect(const char*, int, const char*, int, const char* format,
                               va_list arguments) noexcept
{
    if (innermost != nullptr && innermost->text_[0] == '\0')
        std::vsnprintf(innermost->text_.data(), innermost->text_.size(), format, arguments);
}

std::string library_messages::first() const
{
    std::string s(text_.data());
    while (!s.empty() && (s.back() == '\n' || s.back() == ' '))
        s.pop_back();
    return s;
}

} // namespace tactor::alsa
