// SPDX-License-Identifier: MIT
/// \file
/// Errors of wrong values of fields, and of what the system does not give: descriptors, threads, memory in
/// the kernel.
#pragma once

#include <string_view>

#include <tactor/error.hpp>

namespace tactor::detail {

/// About a field, which is its subject.
[[nodiscard]] error bad_field(std::string_view field, std::string_view why, std::string_view hint = {});

/// Throws it; the exception that is being handled, if there is one, is nested in it as its cause, whose errno
/// it has too unless it has one of its own.
[[noreturn]] void throw_caused(const error& e);
/// Throws it; its cause is what the system said: a std::system_error of that errno, where it is not 0.
[[noreturn]] void throw_caused(const error& e, int code);

/// What to do about an errno of that kind; empty for others.
std::string_view advice_for(int code) noexcept;

/// `why` says what was asked for, and the errno in words.
/// \throws error (runtime), always, with its cause.
[[noreturn]] void refused_by_system(std::string_view what, int code, std::string_view why);

} // namespace tactor::detail
