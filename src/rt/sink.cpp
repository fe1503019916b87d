// SPDX-License-Identifier: MIT
#include <tactor/sink.hpp>

namespace tactor {

// Here rather than in alsa/ or engine/: both stand on rt/.
sink::~sink() = default;

} // namespace tactor
