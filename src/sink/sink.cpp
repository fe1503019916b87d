// SPDX-License-Identifier: MIT
#include <tactor/sink.hpp>

namespace tactor {

// Here rather than in alsa/ or engine/: both stand on rt/.
sink::~sink() = default;

std::int64_t sink::xrun_ns() noexcept
{
    return 0;
}

} // namespace tactor
