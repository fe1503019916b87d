// SPDX-License-Identifier: MIT
#include <tactor/player.hpp>

#include "core/kind_table.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr detail::kind_table<start_kind, 3> starts("start", {{start_kind::frame, "frame"},
                                                             {start_kind::time, "time"},
                                                             {start_kind::trigger, "trigger"}});
constexpr detail::kind_table<state_kind, 3> states("state", {{state_kind::finished, "finished"},
                                                             {state_kind::cancelled, "cancelled"},
                                                             {state_kind::interrupted, "interrupted"}});
constexpr detail::kind_table<reason_kind, 15> reasons("reason", {{reason_kind::none, "none"},
                                                                 {reason_kind::xrun, "xrun"},
                                                                 {reason_kind::suspended, "suspended"},
                                                                 {reason_kind::lost, "lost"},
                                                                 {reason_kind::failed, "failed"},
                                                                 {reason_kind::late, "late"},
                                                                 {reason_kind::crowded, "crowded"},
                                                                 {reason_kind::closed, "closed"},
                                                                 {reason_kind::starved, "starved"},
                                                                 {reason_kind::too_long, "too-long"},
                                                                 {reason_kind::muted, "muted"},
                                                                 {reason_kind::amplifier, "amplifier"},
                                                                 {reason_kind::left_on, "left-on"},
                                                                 {reason_kind::plan, "plan"},
                                                                 {reason_kind::handler, "handler"}});
constexpr detail::kind_table<wait_kind, 4> waits("wait", {{wait_kind::ended, "ended"},
                                                          {wait_kind::timeout, "timeout"},
                                                          {wait_kind::taken, "taken"},
                                                          {wait_kind::unknown, "unknown"}});

} // namespace

TACTOR_KIND_FUNCTIONS(start_kind, starts)
TACTOR_KIND_FUNCTIONS(state_kind, states)
TACTOR_KIND_FUNCTIONS(reason_kind, reasons)
TACTOR_KIND_FUNCTIONS(wait_kind, waits)

} // namespace v0
} // namespace tactor
