// SPDX-License-Identifier: MIT
/// \file
/// Compiles loops for any x86-64, for AVX2 and for AVX-512. The loader chooses the best version that the
/// processor supports. All versions do the same operations on each sample, without contraction, so their
/// samples are equal.
#pragma once

#include <cstddef> // defines __GLIBC__ if the C library is glibc

// The loader chooses before sanitizers are initialised, so builds with sanitizers have only one version.
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&    \
    !defined(__SANITIZE_THREAD__)
#define TACTOR_HAS_CLONES
#define TACTOR_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define TACTOR_CLONES
#endif
