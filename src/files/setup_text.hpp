// SPDX-License-Identifier: MIT
/// \file
/// Arrays and what their files say, as TOML that load_setup() reads again.
#pragma once

#include <string>
#include <string_view>

#include <tactor/setup.hpp>

namespace tactor::detail {

/// A TOML string in double quotes.
std::string toml_string(std::string_view s);

/// The tables [array] and [[tactor]], which say all of an array.
std::string array_text(const array& a);

/// The tables [output], [amplifier], [sync], [limits] and [defaults]. Two setups with the same text drive an
/// array alike.
std::string besides_text(const setup& besides);

/// An array file with both. It needs no other file.
std::string array_text(const array& a, const setup& besides);

/// The tables [calibration] and [[calibration.tactor]].
std::string origin_text(const calibration_origin& o);

} // namespace tactor::detail
