// SPDX-License-Identifier: MIT
/// \file
/// What people read: text that cannot steer their terminal.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace tactor::cli {

/// A name from a file or the command line as a terminal may get it: control characters, which could move its
/// cursor or worse, become escapes such as \x1b or \n.
std::string shown(std::string_view name);

/// Prints text, escaped as above but for line ends. Never throws for what cannot be written: standard error
/// that is gone (2>&-, a full disk) does not decide whether the work was done, and main() looks after
/// standard output.
void say_text(std::FILE* to, std::string_view text);

template <typename... T>
void say(std::FILE* to, fmt::format_string<T...> format, T&&... values)
{
    say_text(to, fmt::format(format, std::forward<T>(values)...));
}

} // namespace tactor::cli
