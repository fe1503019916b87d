// SPDX-License-Identifier: MIT
/// \file
/// The environment of the process, and files in /proc and /dev. A missing or forbidden file counts as empty,
/// but a lack of descriptors throws. Does not use the iterators of std::filesystem or streams: in libstdc++
/// 12 they end the process when memory runs out, or return only a part.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

namespace tactor::rt {

/// Returns a variable of the environment; empty if it is not set.
inline std::string variable(const char* name)
{
    const char* v = std::getenv(name);
    return v == nullptr ? "" : v;
}

/// Returns the first folder of RUNTIME_DIRECTORY, a list that systemd sets for services; empty if it is not
/// set.
inline std::string service_folder()
{
    const std::string all = variable("RUNTIME_DIRECTORY");
    return all.substr(0, all.find(':'));
}

/// Returns the folder for files that last until this machine stops: service_folder(), or XDG_RUNTIME_DIR if
/// that is empty. Empty if neither is set.
inline std::string runtime_folder()
{
    const std::string folder = service_folder();
    return folder.empty() ? variable("XDG_RUNTIME_DIR") : folder;
}

/// Returns the names in a folder, in no particular order, without "." and "..".
/// \throws error (runtime) when the process has no descriptors left.
std::vector<std::string> read_folder_names(const std::string& folder);

/// Reads a small file as a whole. Throws as read_folder_names() does.
std::string read_file(const std::string& file);

} // namespace tactor::rt
