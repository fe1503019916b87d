// SPDX-License-Identifier: MIT
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>

#include "core/kind_table.hpp"

namespace tactor {
inline namespace v0 {

TACTOR_KIND_NAMES(error_kind, "kind of error", {bad_input, "bad-input"}, {runtime, "runtime"},
                  {not_available, "not-available"});
TACTOR_KIND_NAMES(actuator_kind, "actuator", {unknown, "unknown"}, {piezo, "piezo"},
                  {voice_coil, "voice-coil"}, {lra, "lra"}, {erm, "erm"});
TACTOR_KIND_NAMES(note_kind, "note", {none, "none"}, {reconstructed, "reconstructed"});
TACTOR_KIND_NAMES(easing_kind, "easing", {linear, "linear"}, {in_out, "in-out"},
                  {minimum_jerk, "minimum-jerk"});
TACTOR_KIND_NAMES(edge_kind, "edge", {rising, "rising"}, {falling, "falling"}, {both, "both"});
TACTOR_KIND_NAMES(pull_kind, "pull", {as_is, "as-is"}, {none, "none"}, {up, "up"}, {down, "down"});
TACTOR_KIND_NAMES(io_kind, "state of a sink", {ok, "ok"}, {again, "again"}, {xrun, "xrun"},
                  {suspended, "suspended"}, {lost, "lost"}, {failed, "failed"});
TACTOR_KIND_NAMES(log_kind, "kind of log line", {debug, "debug"}, {info, "info"}, {warning, "warning"},
                  {error, "error"});

std::size_t sample_bytes(format_kind f) noexcept
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

TACTOR_KIND_NAMES(format_kind, "sample format", {float32, "float"}, {s16, "s16"}, {s24_3, "s24"},
                  {s24_4, "s24-4"}, {s32, "s32"});

} // namespace v0
} // namespace tactor
