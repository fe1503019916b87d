// SPDX-License-Identifier: MIT
/// \file
/// Export marker, and names of the values of enumerations. Names with TACTOR_API are the interface of
/// libtactor; everything else in the shared library is hidden. An enumeration for a closed set of values is
/// called ..._kind, so that fields can have the plain name. Any thread may call the functions of
/// enumerations, which do not block.
#pragma once

#include <span>
#include <string_view>

// Every header includes this header first. By default, CMake requests the compiler's default standard, C++17.
#if defined(__cplusplus) && __cplusplus < 202002L
#error "tactor needs C++20: -std=c++20 (CMake: cxx_std_20)"
#include "-std=c++20" // no such file: ends the compilation before many errors that explain less
#endif

#if defined(__GNUC__)
#define TACTOR_API __attribute__((visibility("default")))
#else
#define TACTOR_API
#endif

namespace tactor::detail {
struct access; // gives the library access to private members of its classes
} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

/// Returns the value whose to_string() is `name`, for example from_string<phantom_kind>("barycentric").
/// \throws error (bad_input) that lists the names.
template <typename Kind>
[[nodiscard]] Kind from_string(std::string_view name) = delete;

/// Returns all values, in the order of their declaration, for menus and loops.
template <typename Kind>
[[nodiscard]] std::span<const Kind> all_values() noexcept = delete;

} // namespace v0
} // namespace tactor

/// Declares to_string(), from_string<>() and all_values<>() for an enumeration, in its namespace. to_string()
/// returns "unknown" for a number that is not a value of the enumeration.
#define TACTOR_KIND(Kind)                                                                                    \
    TACTOR_API std::string_view to_string(Kind k) noexcept;                                                  \
    template <>                                                                                              \
    TACTOR_API Kind from_string<Kind>(std::string_view name);                                                \
    template <>                                                                                              \
    TACTOR_API std::span<const Kind> all_values<Kind>() noexcept
