// SPDX-License-Identifier: MIT
/// \file
/// What a recording is called in messages.
#pragma once

#include <string>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// Its file, or what it is where it came from none.
inline std::string name_of(const recording& r)
{
    return r.file.empty() ? "recording" : r.file;
}

} // namespace tactor::detail
