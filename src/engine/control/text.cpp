// SPDX-License-Identifier: MIT
#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "engine/control/feeder.hpp"

namespace tactor {

namespace engine {

std::string text(reason r, int code)
{
    switch (r) {
    case reason::none:
        return "";
    case reason::xrun:
        return "xrun: the device ran dry";
    case reason::suspended:
        return "the system was suspended";
    case reason::lost:
        switch (-code) {
        case ETIMEDOUT:
            return "the device does not move any more";
        case EPIPE:
            return "the device was given up: one xrun after the other";
        default:
            return "the device is gone";
        }
    case reason::failed:
        return code == 0 ? "the device failed"
                         : fmt::format("the device failed: {}",
                                       std::error_code(-code, std::generic_category()).message());
    case reason::late:
        return "the computer was too slow to prepare the stroke in time";
    case reason::crowded:
        return "too many strokes at once (let fewer overlap; bursts need less than continuous strokes)";
    case reason::starved:
        return "no more points came";
    case reason::too_long:
        return "it has lasted as long as it may";
    case reason::muted:
        return "the amplifier was off";
    case reason::amplifier:
        return "the amplifier's line cannot be switched";
    case reason::left_on:
        return "the amplifier's line cannot be switched off: it may be on";
    case reason::plan:
        return "the plan failed";
    case reason::closed:
        return "the player was closed";
    }
    return "";
}

} // namespace engine
} // namespace tactor
