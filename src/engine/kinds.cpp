// SPDX-License-Identifier: MIT
#include <tactor/player.hpp>

#include "core/kind_table.hpp"

namespace tactor {
namespace {

constexpr detail::kind_table<start_kind, 3> starts("start", {{start_kind::frame, "frame"},
                                                             {start_kind::time, "time"},
                                                             {start_kind::trigger, "trigger"}});
constexpr detail::kind_table<state_kind, 3> states("state", {{state_kind::finished, "finished"},
                                                             {state_kind::cancelled, "cancelled"},
                                                             {state_kind::interrupted, "interrupted"}});

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

} // namespace tactor
