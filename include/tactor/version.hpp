// SPDX-License-Identifier: MIT
/// \file
/// Version of the library that runs.
#pragma once

#include <string>

#include <tactor/api.hpp>

namespace tactor {

/// "0.1.0".
TACTOR_API const char* version() noexcept;

/// What a bug report should say of this library: how and with what it was built, and which of its loops this
/// processor runs. Some lines for people. Any thread.
TACTOR_API std::string build_facts();

} // namespace tactor
