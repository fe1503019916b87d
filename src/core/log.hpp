// SPDX-License-Identifier: MIT
// Log lines of the program.
#pragma once

#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Formats a line and passes it to `to`. Does nothing if `to` is empty. Drops exceptions, because a log must
/// not make its caller fail.
template <typename... T>
void log(const log_function& to, log_kind k, fmt::format_string<T...> format, T&&... values) noexcept
{
    if (!to)
        return;
    try {
        to(k, fmt::format(format, std::forward<T>(values)...));
    } catch (...) { // NOLINT(bugprone-empty-catch): there is no place to report it
    }
}

} // namespace tactor::detail
