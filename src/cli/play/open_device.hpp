// SPDX-License-Identifier: MIT
/// \file
/// Opening a PCM, with advice where it has too few channels.
#pragma once

#include <memory>
#include <string>

#include <tactor/alsa.hpp>

namespace tactor::cli {

/// Names the largest built-in array that the PCM can play as `o` asks for; empty: none.
std::string find_array_that_fits(alsa_options o);

/// Opens like open_alsa(); if the PCM has too few channels, the hint names an array that fits.
std::unique_ptr<sink> open_device(const alsa_options& o);

} // namespace tactor::cli
