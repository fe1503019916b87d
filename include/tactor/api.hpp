// SPDX-License-Identifier: MIT
/// \file
/// Export marker: names that carry it are the interface of libtactor; everything else in the shared library
/// is hidden.
#pragma once

// Each header includes this one before all that needs it. CMake asks for the compiler's default, C++17.
#if defined(__cplusplus) && __cplusplus < 202002L
#error "tactor needs C++20: -std=c++20 (CMake: cxx_std_20)"
#include "-std=c++20" // no such file: ends the compilation before a wall of errors that say less
#endif

#if defined(__GNUC__)
#define TACTOR_API __attribute__((visibility("default")))
#else
#define TACTOR_API
#endif

namespace tactor::detail {
struct access; // the library's own way into its classes
} // namespace tactor::detail
