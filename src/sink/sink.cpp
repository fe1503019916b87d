// SPDX-License-Identifier: MIT
#include <tactor/sink.hpp>

namespace tactor {
inline namespace v0 {

// Here rather than in alsa/ or engine/: both stand on rt/.
sink::~sink() = default;

std::int64_t sink::xrun_ns() noexcept
{
    return 0;
}

} // namespace v0
} // namespace tactor
