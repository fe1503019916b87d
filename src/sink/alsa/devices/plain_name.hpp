// SPDX-License-Identifier: MIT
/// \file
/// The grammar of PCM names that are names and nothing else.
#pragma once

#include <string>
#include <string_view>

namespace tactor::pcm {

/// Why this text is more than the name of a device; empty: it is not. Names are
///
///     NAME = BASE [":" ARGUMENT {"," ARGUMENT}] | "plug:" ["SLAVE="] (INNER | "'" NAME "'")
///     ARGUMENT = [KEY "="] VALUE
///
/// with letters, digits, "_" and "-" (in a VALUE "." too). INNER is a NAME without a comma, which would end
/// it. A NAME within "plug:" does not begin with "plug:" again. ALSA itself takes far more: definitions in
/// braces, quoted text, escapes. Looks at the text only; find_route() tells what a name stands for.
std::string not_plain(std::string_view name);

} // namespace tactor::pcm
