// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>

#include "core/kind_names.hpp"

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

TACTOR_KIND_NAMES(algorithm_kind, "algorithm", {park2016, "park2016"}, {tactile_brush, "tactile-brush"},
                  {continuous, "continuous"});
TACTOR_KIND_NAMES(phantom_kind, "phantom", {inverse_distance, "inverse-distance"},
                  {barycentric, "barycentric"}, {linear, "linear"}, {log, "log"}, {gaussian, "gaussian"});
TACTOR_KIND_NAMES(faces_kind, "faces", {delaunay, "delaunay"}, {nearest, "nearest"});
TACTOR_KIND_NAMES(timing_kind, "timing", {fixed, "fixed"}, {fit, "fit"});
TACTOR_KIND_NAMES(outside_kind, "outside", {error, "error"}, {clamp, "clamp"});
TACTOR_KIND_NAMES(overlap_kind, "overlap", {energy, "energy"}, {max, "max"}, {sum, "sum"});
TACTOR_KIND_NAMES(scale_kind, "intensity scale", {linear, "linear"}, {sl, "sl"}, {stevens, "stevens"});
TACTOR_KIND_NAMES(phase_kind, "phase", {stroke, "stroke"}, {burst, "burst"});
TACTOR_KIND_NAMES(together_kind, "together", {weaken, "weaken"}, {sum, "sum"});
TACTOR_KIND_NAMES(observer_kind, "observer", {centroid, "centroid"}, {low_speed, "low-speed"});
TACTOR_KIND_NAMES(start_from_kind, "start_from", {piece, "piece"}, {start, "start"}, {end, "end"});

std::size_t sample_bytes(format_kind f) noexcept
{
    return f == format_kind::s16 ? 2 : f == format_kind::s24_3 ? 3 : 4;
}

TACTOR_KIND_NAMES(format_kind, "sample format", {float32, "float"}, {s16, "s16"}, {s24_3, "s24"},
                  {s24_4, "s24-4"}, {s32, "s32"});

double resolve_start_s(std::optional<double> start_s, const start_anchor& anchor,
                       std::span<const double> starts_s, std::span<const double> ends_s)
{
    if (!start_s)
        return ends_s.empty() ? 0.0 : ends_s.back();
    if (anchor.from == start_from_kind::piece) {
        if (*start_s >= 0.0)
            return *start_s;
        throw error(error_kind::bad_input, "start of the stroke",
                    fmt::format("{} s is not a time from the start of the piece", *start_s),
                    "use 0 s or more")
            .with_field("start_s");
    }
    double from = 0.0;
    const std::size_t back = anchor.back;
    if (anchor.from == start_from_kind::start)
        from = back >= 1 && back <= starts_s.size() ? starts_s[starts_s.size() - back] : 0.0;
    else
        for (const double end : ends_s.last(std::min(back, ends_s.size())))
            from = std::max(from, end);
    if (from + *start_s >= 0.0)
        return from + *start_s;
    throw error(error_kind::bad_input, "start of the stroke",
                fmt::format("{:g} s before the {} of the previous stroke is before the start of the piece",
                            -*start_s, to_string(anchor.from)),
                fmt::format("give at most {:g} s before that {}", from, to_string(anchor.from)))
        .with_field("start_s");
}

} // namespace v0
} // namespace tactor
