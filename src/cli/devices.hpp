// SPDX-License-Identifier: MIT
/// \file
/// Texts about devices. They are made from values only.
#pragma once

#include <string>
#include <vector>

#include "session/device.hpp"

namespace tactor::cli {

/// Returns a list of devices for people, at most 80 columns wide.
std::string devices_text(const session::device_list& d);

/// Returns a list of processes: "jackd (process 12), a program (process 15)".
std::string process_names(const std::vector<process_info>& all);

} // namespace tactor::cli
