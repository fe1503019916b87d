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

std::string_view to_string(start_kind k) noexcept
{
    return starts.name(k);
}

template <>
start_kind from_string<start_kind>(std::string_view name)
{
    return starts.kind(name);
}

template <>
std::span<const start_kind> values_of<start_kind>() noexcept
{
    return starts.kinds();
}

std::string_view to_string(state_kind k) noexcept
{
    return states.name(k);
}

template <>
state_kind from_string<state_kind>(std::string_view name)
{
    return states.kind(name);
}

template <>
std::span<const state_kind> values_of<state_kind>() noexcept
{
    return states.kinds();
}

std::string_view to_string(reason_kind k) noexcept
{
    return reasons.name(k);
}

template <>
reason_kind from_string<reason_kind>(std::string_view name)
{
    return reasons.kind(name);
}

template <>
std::span<const reason_kind> values_of<reason_kind>() noexcept
{
    return reasons.kinds();
}

std::string_view to_string(wait_kind k) noexcept
{
    return waits.name(k);
}

template <>
wait_kind from_string<wait_kind>(std::string_view name)
{
    return waits.kind(name);
}

template <>
std::span<const wait_kind> values_of<wait_kind>() noexcept
{
    return waits.kinds();
}

} // namespace v0
} // namespace tactor
