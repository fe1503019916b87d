// SPDX-License-Identifier: MIT
/// \file
/// Closed sets are enumerations, called ..._kind, so that fields can have the plain names. Each has its
/// to_string(), and here is the way back. Any thread; nothing blocks.
#pragma once

#include <span>
#include <string_view>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// Returns the value whose to_string() is `name`: from_string<phantom_kind>("barycentric").
/// \throws error (bad_input) that lists the names.
template <typename Kind>
[[nodiscard]] Kind from_string(std::string_view name) = delete;

/// Returns all values, in the order of their declaration, for menus and loops.
template <typename Kind>
[[nodiscard]] std::span<const Kind> values_of() noexcept = delete;

} // namespace v0
} // namespace tactor

/// Declares the words of an enumeration, in its own namespace: to_string(), "unknown" for what is no value of
/// it, from_string<>() and values_of<>().
#define TACTOR_KIND(Kind)                                                                                    \
    TACTOR_API std::string_view to_string(Kind k) noexcept;                                                  \
    template <>                                                                                              \
    TACTOR_API Kind from_string<Kind>(std::string_view name);                                                \
    template <>                                                                                              \
    TACTOR_API std::span<const Kind> values_of<Kind>() noexcept
