// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "session/device_list.hpp"

namespace tactor::cli {

/// Returns a list of devices for people, at most 80 columns wide.
std::string devices_text(const session::device_list& d);

} // namespace tactor::cli
