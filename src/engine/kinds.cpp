// SPDX-License-Identifier: MIT
#include <tactor/player.hpp>

#include "core/kind_table.hpp"

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
