// SPDX-License-Identifier: MIT
#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/log.hpp>
#include <tactor/movement.hpp>
#include <tactor/sample_format.hpp>
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

constexpr detail::kind_table<format_kind, 5> formats("sample format", {{format_kind::float32, "float"},
                                                                       {format_kind::s16, "s16"},
                                                                       {format_kind::s24_3, "s24"},
                                                                       {format_kind::s24_4, "s24-4"},
                                                                       {format_kind::s32, "s32"}});

} // namespace

TACTOR_KIND_FUNCTIONS(error_kind, errors)
TACTOR_KIND_FUNCTIONS(actuator_kind, actuators)
TACTOR_KIND_FUNCTIONS(note_kind, notes)
TACTOR_KIND_FUNCTIONS(easing_kind, easings)
TACTOR_KIND_FUNCTIONS(edge_kind, edges)
TACTOR_KIND_FUNCTIONS(pull_kind, pulls)
TACTOR_KIND_FUNCTIONS(io_kind, states)
TACTOR_KIND_FUNCTIONS(log_kind, log_kinds)

std::size_t bytes_of(format_kind f) noexcept
{
    switch (f) {
    case format_kind::s16:
        return 2;
    case format_kind::s24_3:
        return 3;
    case format_kind::float32:
    case format_kind::s24_4:
    case format_kind::s32:
        break;
    }
    return 4;
}

TACTOR_KIND_FUNCTIONS(format_kind, formats)

} // namespace v0
} // namespace tactor
