// SPDX-License-Identifier: MIT
#include "sink/alsa/library_messages.hpp"

#include <algorithm>
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
    if (innermost == nullptr)
        return;
    std::array<char, 1000>& text = innermost->text_;
    std::size_t& length = innermost->length_;
    const int n = std::vsnprintf(text.data() + length, text.size() - length, format, arguments);
    length = std::min(length + static_cast<std::size_t>(std::max(n, 0)), text.size() - 2);
    text[length++] = '\n';
}

std::string library_messages::all() const
{
    return {text_.data(), length_};
}

std::string library_messages::first() const
{
    std::string s = all();
    s.resize(std::min(s.find('\n'), s.size()));
    while (!s.empty() && (s.back() == '\n' || s.back() == ' '))
        s.pop_back();
    return s;
}

} // namespace tactor::alsa
