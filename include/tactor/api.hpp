// SPDX-License-Identifier: MIT
/// \file
/// Export marker: what carries it is the interface of libtactor; everything else in the shared
/// library is hidden.
#pragma once

#if defined(__GNUC__)
#define TACTOR_API __attribute__((visibility("default")))
#else
#define TACTOR_API
#endif

namespace tactor::detail {
struct access; // the library's own way into its classes
} // namespace tactor::detail
