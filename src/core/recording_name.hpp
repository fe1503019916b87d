// SPDX-License-Identifier: MIT
/// \file
/// Name of a recording in messages.
#pragma once

#include <string>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// Returns the recording's file, or "recording" if it has none.
inline std::string recording_name(const recording& r)
{
    return r.file.empty() ? "recording" : r.file;
}

} // namespace tactor::detail
