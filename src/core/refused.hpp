// SPDX-License-Identifier: MIT
/// \file
/// Errors of wrong values of fields, and of resources that the system refuses: descriptors, threads, memory
/// in the kernel.
#pragma once

#include <string_view>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Returns an error about a field, which is its subject.
[[nodiscard]] error bad_field(std::string_view field, std::string_view why, std::string_view hint = {});

/// Throws `e`. If an exception is being handled, it becomes the nested cause, and `e` takes its errno unless
/// it has one.
[[noreturn]] void throw_caused(const error& e);
/// Throws `e`. Unless `code` is 0, a std::system_error with that errno becomes the nested cause.
[[noreturn]] void throw_caused(const error& e, int code);

/// Returns a hint for an errno of lacking resources; empty for others.
std::string_view advice_for(int code) noexcept;

/// Throws for a refused resource, with a hint for the errno `code`. `why`: what was refused, with the errno
/// in words. \throws error (runtime), always, with its cause.
[[noreturn]] void refused_by_system(std::string_view what, int code, std::string_view why);

} // namespace tactor::detail
