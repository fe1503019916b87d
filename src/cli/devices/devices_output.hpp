// SPDX-License-Identifier: MIT
/// \file
/// Lists the devices to play on, and prints them for `devices`.
#pragma once

#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/environment.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {

/// What there is, and what it is looked at for.
struct device_list {
    std::string array_name;
    alsa_options wanted;            ///< as play would open it
    bool pcm_is_configured = false; ///< by -D or a file; else `wanted` stands on the default
    std::vector<pcm_info> pcms;
    std::vector<gpio_chip_info> chips;
};

/// Looks at all devices, for what the settings ask for. \throws error.
device_list look_for_devices(const settings& s, const environment& e);

/// For people, at most 80 columns wide.
std::string devices_text(const device_list& d);

/// One object of schema tactor-devices/1.
std::string devices_json(const device_list& d);

} // namespace tactor::cli
