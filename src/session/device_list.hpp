// SPDX-License-Identifier: MIT
/// \file
/// Devices to play on.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tactor/tactor.hpp>

#include "session/environment.hpp"

namespace tactor::session {

/// Devices that there are, and how play would open one.
struct device_list {
    std::string array_name;
    alsa_options wanted;            ///< as play would open it
    bool pcm_is_configured = false; ///< by -D or a file; else `wanted` stands on the default
    std::vector<pcm_info> pcms;
    std::vector<gpio_chip_info> chips;
};

/// Looks at all devices, for what the settings ask for. \throws error.
device_list look_for_devices(const settings& s, const environment& e);

/// Returns one object of schema tactor-devices/1.
std::string devices_json(const device_list& d);
/// Returns the schema of such an object.
nlohmann::ordered_json devices_schema();

} // namespace tactor::session
