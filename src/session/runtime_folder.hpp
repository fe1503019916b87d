// SPDX-License-Identifier: MIT
/// \file
/// Where what lives no longer than this machine's run is kept.
#pragma once

#include <string>

namespace tactor::session {

/// The first of RUNTIME_DIRECTORY, which systemd gives to services and may be a list; empty where there is
/// none.
std::string service_folder();

/// service_folder(), else XDG_RUNTIME_DIR; empty where nothing says which.
std::string runtime_folder();

} // namespace tactor::session
