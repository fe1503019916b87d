// SPDX-License-Identifier: MIT
/// \file
/// The grammar of PCM names that are names and nothing else.
#pragma once

#include <string>
#include <string_view>

namespace tactor::pcm {

/// What makes this text more than the name of a device; empty: nothing does. Names are
///
///     NAME = BASE [":" ARGUMENT {"," ARGUMENT}] | "plug:" ["SLAVE="] (INNER | "'" NAME "'")
///     ARGUMENT = [KEY "="] VALUE
///
/// with letters, digits, "_" and "-" (in a VALUE "." too); INNER is a NAME without a comma, which would end
/// it, and no NAME within "plug:" begins so again. ALSA itself takes far more: definitions in braces,
/// quoted text, escapes. Looks at the text only; what a name stands for, find_route() tells.
std::string not_plain(std::string_view name);

} // namespace tactor::pcm
