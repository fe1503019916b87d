// SPDX-License-Identifier: MIT
/// \file
/// What `devices` prints, from plain values.
#pragma once

#include <string>
#include <vector>

#include <tactor/tactor.hpp>

namespace tactor::cli {

/// What there is, and what it is looked at for.
struct device_list {
    std::string array_name;
    alsa_options wanted;            ///< as play would open it
    bool pcm_is_configured = false; ///< by -D or a file; else `wanted` stands on the default
    std::vector<pcm_info> pcms;
    std::vector<gpio_chip_info> chips;
};

/// For people, at most 80 columns wide.
std::string devices_text(const device_list& d);

/// One object of schema tactor-devices/1.
std::string devices_json(const device_list& d);

} // namespace tactor::cli
