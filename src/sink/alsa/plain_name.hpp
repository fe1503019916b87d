// SPDX-License-Identifier: MIT
/// \file
/// Grammar of PCM names that only name a device.
#pragma once

#include <string>
#include <string_view>

namespace tactor::alsa {

/// Returns why this text is more than the name of a device; empty if it is not. Names are
///
///     NAME = BASE [":" ARGUMENT {"," ARGUMENT}] | "plug:" ["SLAVE="] (INNER | "'" NAME "'")
///     ARGUMENT = [KEY "="] VALUE
///
/// with letters, digits, "_" and "-" (in a VALUE also "."). INNER is a NAME without a comma, which would end
/// it. A NAME within "plug:" does not begin with "plug:" again. ALSA itself accepts much more: definitions in
/// braces, quoted text, escapes. Looks only at the text; find_route() finds what a name leads to.
std::string not_plain(std::string_view name);

} // namespace tactor::alsa
