// SPDX-License-Identifier: MIT
/// \file
/// The environment of the process.
#pragma once

#include <cstdlib>
#include <string>

namespace tactor::session {

/// A variable of the environment; empty where it is not set.
inline std::string variable(const char* name)
{
    const char* v = std::getenv(name);
    return v == nullptr ? "" : v;
}

} // namespace tactor::session
