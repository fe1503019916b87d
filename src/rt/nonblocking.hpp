// SPDX-License-Identifier: MIT
/// \file
/// Mark for code that must not block. clang 20 and later check it at run time (RealtimeSanitizer,
/// tests/lanes/realtime); other compilers ignore it.
#pragma once

#if defined(__clang__) && __has_cpp_attribute(clang::nonblocking)
/// Attribute after a function's noexcept: neither the function nor its callees may allocate, lock or wait.
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

/// Scope in which the current thread may call the kernel. The audio thread must call it for the device and to
/// wake other threads.
#ifdef TACTOR_CHECKS_NONBLOCKING
using permitted_call = __rtsan::ScopedDisabler;
#else
struct [[maybe_unused]] permitted_call {};
#endif

} // namespace tactor::rt
