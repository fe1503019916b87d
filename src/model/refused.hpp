// SPDX-License-Identifier: MIT
/// \file
/// What the system does not give: descriptors, threads, memory in the kernel.
#pragma once

#include <string_view>

namespace tactor::detail {

/// What to do about an errno of that kind; empty for others.
std::string_view advice_for(int code) noexcept;

/// `why` says what was asked for, and the errno in words.
/// \throws error (runtime), always.
[[noreturn]] void refused_by_system(std::string_view what, int code, std::string_view why);

} // namespace tactor::detail
