// SPDX-License-Identifier: MIT
/// \file
/// Grammar of PCM names that only name a device.
#pragma once

#include <string>
#include <string_view>

namespace tactor::alsa {

/// Returns why a text is not the plain name of a device; empty if it is. Plain names are
///
///     NAME = BASE [":" ARGUMENT {"," ARGUMENT}] | "plug:" ["SLAVE="] (INNER | "'" NAME "'")
///     ARGUMENT = [KEY "="] VALUE
///
/// where BASE, KEY and VALUE consist of letters, digits, "_" and "-" (a VALUE also of "."). INNER is a NAME
/// without a comma, because a comma would end it. A NAME within "plug:" does not begin with "plug:" again.
/// ALSA itself accepts much more: definitions in braces, quoted text, escapes. Looks only at the text;
/// find_route() finds the device to which a name leads.
std::string find_plain_name_fault(std::string_view name);

} // namespace tactor::alsa
