// SPDX-License-Identifier: MIT
#include <tactor/choices.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/kind_table.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr detail::kind_table<algorithm_kind, 3> algorithms("algorithm",
                                                           {{algorithm_kind::park2016, "park2016"},
                                                            {algorithm_kind::tactile_brush, "tactile-brush"},
                                                            {algorithm_kind::continuous, "continuous"}});
constexpr detail::kind_table<phantom_kind, 5> phantoms("phantom",
                                                       {{phantom_kind::inverse_distance, "inverse-distance"},
                                                        {phantom_kind::barycentric, "barycentric"},
                                                        {phantom_kind::linear, "linear"},
                                                        {phantom_kind::log, "log"},
                                                        {phantom_kind::gaussian, "gaussian"}});
constexpr detail::kind_table<faces_kind, 2> all_faces("faces", {{faces_kind::delaunay, "delaunay"},
                                                                {faces_kind::nearest, "nearest"}});
constexpr detail::kind_table<timing_kind, 2> timings("timing", {{timing_kind::fixed, "fixed"},
                                                                {timing_kind::fit, "fit"}});
constexpr detail::kind_table<outside_kind, 2> outsides("outside", {{outside_kind::error, "error"},
                                                                   {outside_kind::clamp, "clamp"}});
constexpr detail::kind_table<overlap_kind, 3> overlaps("overlap", {{overlap_kind::energy, "energy"},
                                                                   {overlap_kind::max, "max"},
                                                                   {overlap_kind::sum, "sum"}});
constexpr detail::kind_table<scale_kind, 3> scales("intensity scale", {{scale_kind::linear, "linear"},
                                                                       {scale_kind::sl, "sl"},
                                                                       {scale_kind::stevens, "stevens"}});
constexpr detail::kind_table<phase_kind, 2> phases("phase", {{phase_kind::stroke, "stroke"},
                                                             {phase_kind::burst, "burst"}});
constexpr detail::kind_table<observer_kind, 2>
    observers("observer", {{observer_kind::centroid, "centroid"}, {observer_kind::low_speed, "low-speed"}});
constexpr detail::kind_table<start_from_kind, 3> start_froms("start_from", {{start_from_kind::piece, "piece"},
                                                                            {start_from_kind::start, "start"},
                                                                            {start_from_kind::end, "end"}});

} // namespace

TACTOR_KIND_FUNCTIONS(algorithm_kind, algorithms)
TACTOR_KIND_FUNCTIONS(phantom_kind, phantoms)
TACTOR_KIND_FUNCTIONS(faces_kind, all_faces)
TACTOR_KIND_FUNCTIONS(timing_kind, timings)
TACTOR_KIND_FUNCTIONS(outside_kind, outsides)
TACTOR_KIND_FUNCTIONS(overlap_kind, overlaps)
TACTOR_KIND_FUNCTIONS(scale_kind, scales)
TACTOR_KIND_FUNCTIONS(phase_kind, phases)
TACTOR_KIND_FUNCTIONS(observer_kind, observers)
TACTOR_KIND_FUNCTIONS(start_from_kind, start_froms)

double resolve_start_s(std::optional<double> start_s, const start_anchor& anchor,
                       std::span<const double> starts_s, std::span<const double> ends_s)
{
    if (!start_s)
        return ends_s.empty() ? 0.0 : ends_s.back();
    if (anchor.from == start_from_kind::piece)
        return *start_s;
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
                fmt::format("{:g} s before the {} of what comes before it is before the piece", -*start_s,
                            to_string(anchor.from)),
                fmt::format("{:g} s before is the start of the piece", from))
        .with_field("start_s");
}

} // namespace v0
} // namespace tactor
