// SPDX-License-Identifier: MIT
/// \file
/// Errors about fields with wrong values, and about resources that the system refuses: descriptors, threads,
/// kernel memory.
#pragma once

#include <string_view>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Returns an error about a field, which is its subject.
[[nodiscard]] error bad_field(std::string_view field, std::string_view why, std::string_view hint = {});

/// Throws `e`. If an exception is being handled, that exception becomes the nested cause. If `e` has no
/// errno, it gets the errno of the cause.
[[noreturn]] void throw_with_cause(const error& e);
/// Throws `e`. If `code` is not 0, a std::system_error with this errno becomes the nested cause.
[[noreturn]] void throw_with_cause(const error& e, int code);

/// Returns a hint for an errno that means a lack of resources, or "" for any other errno.
std::string_view errno_hint(int code) noexcept;

/// Throws an error about a refused resource, with a hint for the errno `code`. `why` says what was refused
/// and contains the errno in words.
/// \throws error (runtime), always, with a nested cause.
[[noreturn]] void throw_resource_error(std::string_view what, int code, std::string_view why);

} // namespace tactor::detail
