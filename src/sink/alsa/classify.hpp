// SPDX-License-Identifier: MIT
/// \file
/// What ALSA's error numbers and states mean for the stream.
#pragma once

#include <alsa/asoundlib.h>

#include <tactor/sink.hpp>

namespace tactor::pcm {

/// What a state alone says; a negative value is an error number (a device that is gone).
io_kind of_state(int state) noexcept;

/// What a negative return value in a state says.
io_kind of_error(long code, int state) noexcept;

} // namespace tactor::pcm
