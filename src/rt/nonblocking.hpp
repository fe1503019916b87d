// SPDX-License-Identifier: MIT
/// \file
/// What must not block, said in a way that a compiler can hold it to: clang 20 and later do at run time
/// (RealtimeSanitizer, tests/lanes/realtime), others see nothing.
#pragma once

#if defined(__clang__) && __has_cpp_attribute(clang::nonblocking)
/// Behind a function's noexcept: neither it nor what it calls may allocate, lock or wait.
#define TACTOR_NONBLOCKING [[clang::nonblocking]]
#else
#define TACTOR_NONBLOCKING
#endif

#if defined(__has_feature)
#if __has_feature(realtime_sanitizer)
#define TACTOR_CHECKS_NONBLOCKING
#include <sanitizer/rtsan_interface.h>
#endif
#endif

namespace tactor::rt {

/// While one lives, its thread may call the kernel, as the audio thread has to for the device and to wake
/// others.
#ifdef TACTOR_CHECKS_NONBLOCKING
using permitted_call = __rtsan::ScopedDisabler;
#else
struct [[maybe_unused]] permitted_call {};
#endif

} // namespace tactor::rt
