// SPDX-License-Identifier: MIT
/// \file
/// The environment of the process.
#pragma once

#include <cstdlib>
#include <string>

namespace tactor::rt {

/// A variable of the environment; empty where it is not set.
inline std::string variable(const char* name)
{
    const char* v = std::getenv(name);
    return v == nullptr ? "" : v;
}

/// Returns the first of RUNTIME_DIRECTORY, which systemd gives to services and may be a list; empty where
/// there is none.
inline std::string service_folder()
{
    const std::string all = variable("RUNTIME_DIRECTORY");
    return all.substr(0, all.find(':'));
}

/// Returns the folder of what lives no longer than this machine's run: service_folder(), else
/// XDG_RUNTIME_DIR; empty where nothing says which.
inline std::string runtime_folder()
{
    const std::string folder = service_folder();
    return folder.empty() ? variable("XDG_RUNTIME_DIR") : folder;
}

} // namespace tactor::rt
