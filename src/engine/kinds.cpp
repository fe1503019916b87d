// SPDX-License-Identifier: MIT
#include <tactor/player.hpp>

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/kind_names.hpp"
#include "engine/control/feeder.hpp"

namespace tactor {
inline namespace v0 {

TACTOR_KIND_NAMES(start_kind, "start", {frame, "frame"}, {time, "time"}, {trigger, "trigger"});
TACTOR_KIND_NAMES(state_kind, "state", {finished, "finished"}, {cancelled, "cancelled"},
                  {interrupted, "interrupted"});
TACTOR_KIND_NAMES(reason_kind, "reason", {none, "none"}, {xrun, "xrun"}, {suspended, "suspended"},
                  {lost, "lost"}, {failed, "failed"}, {late, "late"}, {crowded, "crowded"},
                  {closed, "closed"}, {starved, "starved"}, {too_long, "too-long"}, {muted, "muted"},
                  {amplifier, "amplifier"}, {left_on, "left-on"}, {plan, "plan"}, {handler, "handler"});
TACTOR_KIND_NAMES(wait_kind, "wait", {ended, "ended"}, {timeout, "timeout"}, {taken, "taken"},
                  {unknown, "unknown"});

} // namespace v0
} // namespace tactor

namespace tactor::engine {

std::string text(reason_kind r, int code)
{
    switch (r) {
    case reason_kind::none:
        return "";
    case reason_kind::xrun:
        return "xrun: the device ran dry";
    case reason_kind::suspended:
        return "the system was suspended";
    case reason_kind::lost:
        switch (-code) {
        case ETIMEDOUT:
            return "the device does not move any more";
        case EPIPE:
            return "the device was given up: one xrun after the other";
        default:
            return "the device is gone";
        }
    case reason_kind::failed:
        return code == 0 ? "the device failed"
                         : fmt::format("the device failed: {}",
                                       std::error_code(-code, std::generic_category()).message());
    case reason_kind::late:
        return "the computer was too slow to prepare the stroke in time";
    case reason_kind::crowded:
        return "too many strokes at once (let fewer overlap; bursts need less than continuous strokes)";
    case reason_kind::starved:
        return "no more points came";
    case reason_kind::too_long:
        return "it has lasted as long as it may";
    case reason_kind::muted:
        return "the amplifier was off";
    case reason_kind::amplifier:
        return "the amplifier's line cannot be switched";
    case reason_kind::left_on:
        return "the amplifier's line cannot be switched off: it may be on";
    case reason_kind::plan:
        return "the plan failed";
    case reason_kind::handler:
        return "a handler threw";
    case reason_kind::closed:
        return "the player was closed";
    }
    return "";
}

stroke_report interrupted(stroke_id id, reason_kind r, std::string why)
{
    return {.id = id, .state = state_kind::interrupted, .reason = r, .why = std::move(why)};
}

} // namespace tactor::engine
