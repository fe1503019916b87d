// SPDX-License-Identifier: MIT
/// \file
/// What ALSA's error numbers and states mean for the stream.
#pragma once

#include <alsa/asoundlib.h>

#include <tactor/sink.hpp>

namespace tactor::pcm {

/// The meaning of a state alone; a negative value is an error number (a device that is gone).
io_kind of_state(int state) noexcept;

/// The meaning of a negative return value in a state.
io_kind of_error(long code, int state) noexcept;

} // namespace tactor::pcm
