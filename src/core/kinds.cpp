// SPDX-License-Identifier: MIT
#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/log.hpp>
#include <tactor/movement.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>

#include "core/kind_table.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr detail::kind_table<error_kind, 3> errors("kind of error",
                                                   {{error_kind::bad_input, "bad-input"},
                                                    {error_kind::runtime, "runtime"},
                                                    {error_kind::not_available, "not-available"}});
constexpr detail::kind_table<actuator_kind, 5> actuators("actuator",
                                                         {{actuator_kind::unknown, "unknown"},
                                                          {actuator_kind::piezo, "piezo"},
                                                          {actuator_kind::voice_coil, "voice-coil"},
                                                          {actuator_kind::lra, "lra"},
                                                          {actuator_kind::erm, "erm"}});
constexpr detail::kind_table<note_kind, 2> notes("note", {{note_kind::none, "none"},
                                                          {note_kind::reconstructed, "reconstructed"}});
constexpr detail::kind_table<easing_kind, 3> easings("easing", {{easing_kind::linear, "linear"},
                                                                {easing_kind::in_out, "in-out"},
                                                                {easing_kind::minimum_jerk, "minimum-jerk"}});
constexpr detail::kind_table<edge_kind, 3> edges("edge", {{edge_kind::rising, "rising"},
                                                          {edge_kind::falling, "falling"},
                                                          {edge_kind::both, "both"}});
constexpr detail::kind_table<pull_kind, 4> pulls("pull", {{pull_kind::as_is, "as-is"},
                                                          {pull_kind::none, "none"},
                                                          {pull_kind::up, "up"},
                                                          {pull_kind::down, "down"}});
constexpr detail::kind_table<io_kind, 6> states("state of a sink", {{io_kind::ok, "ok"},
                                                                    {io_kind::again, "again"},
                                                                    {io_kind::xrun, "xrun"},
                                                                    {io_kind::suspended, "suspended"},
                                                                    {io_kind::lost, "lost"},
                                                                    {io_kind::failed, "failed"}});
constexpr detail::kind_table<log_kind, 4> log_kinds("kind of log line", {{log_kind::debug, "debug"},
                                                                         {log_kind::info, "info"},
                                                                         {log_kind::warning, "warning"},
                                                                         {log_kind::error, "error"}});

} // namespace

std::string_view to_string(error_kind k) noexcept
{
    return errors.name(k);
}

template <>
error_kind from_string<error_kind>(std::string_view name)
{
    return errors.kind(name);
}

template <>
std::span<const error_kind> values_of<error_kind>() noexcept
{
    return errors.kinds();
}

std::string_view to_string(actuator_kind k) noexcept
{
    return actuators.name(k);
}

template <>
actuator_kind from_string<actuator_kind>(std::string_view name)
{
    return actuators.kind(name);
}

template <>
std::span<const actuator_kind> values_of<actuator_kind>() noexcept
{
    return actuators.kinds();
}

std::string_view to_string(note_kind k) noexcept
{
    return notes.name(k);
}

template <>
note_kind from_string<note_kind>(std::string_view name)
{
    return notes.kind(name);
}

template <>
std::span<const note_kind> values_of<note_kind>() noexcept
{
    return notes.kinds();
}

std::string_view to_string(easing_kind k) noexcept
{
    return easings.name(k);
}

template <>
easing_kind from_string<easing_kind>(std::string_view name)
{
    return easings.kind(name);
}

template <>
std::span<const easing_kind> values_of<easing_kind>() noexcept
{
    return easings.kinds();
}

std::string_view to_string(edge_kind k) noexcept
{
    return edges.name(k);
}

template <>
edge_kind from_string<edge_kind>(std::string_view name)
{
    return edges.kind(name);
}

template <>
std::span<const edge_kind> values_of<edge_kind>() noexcept
{
    return edges.kinds();
}

std::string_view to_string(pull_kind k) noexcept
{
    return pulls.name(k);
}

template <>
pull_kind from_string<pull_kind>(std::string_view name)
{
    return pulls.kind(name);
}

template <>
std::span<const pull_kind> values_of<pull_kind>() noexcept
{
    return pulls.kinds();
}

std::string_view to_string(io_kind k) noexcept
{
    return states.name(k);
}

template <>
io_kind from_string<io_kind>(std::string_view name)
{
    return states.kind(name);
}

template <>
std::span<const io_kind> values_of<io_kind>() noexcept
{
    return states.kinds();
}

std::string_view to_string(log_kind k) noexcept
{
    return log_kinds.name(k);
}

template <>
log_kind from_string<log_kind>(std::string_view name)
{
    return log_kinds.kind(name);
}

template <>
std::span<const log_kind> values_of<log_kind>() noexcept
{
    return log_kinds.kinds();
}

} // namespace v0
} // namespace tactor
