// SPDX-License-Identifier: MIT
// Writes a line to the program's log.
#pragma once

#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Costs nothing where nobody listens. A log is no reason to fail.
template <typename... T>
void log(const log_function& to, log_kind k, fmt::format_string<T...> format, T&&... values) noexcept
{
    if (!to)
        return;
    try {
        to(k, fmt::format(format, std::forward<T>(values)...));
    } catch (...) { // NOLINT(bugprone-empty-catch): there is nobody to tell
    }
}

} // namespace tactor::detail
