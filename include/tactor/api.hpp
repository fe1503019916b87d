// SPDX-License-Identifier: MIT
/// \file
/// Export marker, and names of the values of enumerations. Names with TACTOR_API are the interface of
/// libtactor; everything else in the shared library is hidden. Closed sets are enumerations called ..._kind,
/// so that fields can have the plain names. Any thread may call their functions; they do not block.
#pragma once

#include <span>
#include <string_view>

// Every header includes this one first. CMake requests the compiler's default, C++17.
#if defined(__cplusplus) && __cplusplus < 202002L
#error "tactor needs C++20: -std=c++20 (CMake: cxx_std_20)"
#include "-std=c++20" // no such file: ends the compilation before many errors that say less
#endif

#if defined(__GNUC__)
#define TACTOR_API __attribute__((visibility("default")))
#else
#define TACTOR_API
#endif

namespace tactor::detail {
struct access; // gives the library access to the inside of its classes
} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

/// Returns the value whose to_string() is `name`: from_string<phantom_kind>("barycentric").
/// \throws error (bad_input) that lists the names.
template <typename Kind>
[[nodiscard]] Kind from_string(std::string_view name) = delete;

/// Returns all values, in the order of their declaration, for menus and loops.
template <typename Kind>
[[nodiscard]] std::span<const Kind> all_values() noexcept = delete;

} // namespace v0
} // namespace tactor

/// Declares the name functions of an enumeration, in its own namespace: to_string(), which returns "unknown"
/// for a number that is no value of it, from_string<>() and all_values<>().
#define TACTOR_KIND(Kind)                                                                                    \
    TACTOR_API std::string_view to_string(Kind k) noexcept;                                                  \
    template <>                                                                                              \
    TACTOR_API Kind from_string<Kind>(std::string_view name);                                                \
    template <>                                                                                              \
    TACTOR_API std::span<const Kind> all_values<Kind>() noexcept
