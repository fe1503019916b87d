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
constexpr detail::kind_table<start_from_kind, 3> start_froms("start_from", {{start_from_kind::piece, "piece"},
                                                                            {start_from_kind::start, "start"},
                                                                            {start_from_kind::end, "end"}});

} // namespace

std::string_view to_string(algorithm_kind k) noexcept
{
    return algorithms.name(k);
}

template <>
algorithm_kind from_string<algorithm_kind>(std::string_view name)
{
    return algorithms.kind(name);
}

template <>
std::span<const algorithm_kind> values_of<algorithm_kind>() noexcept
{
    return algorithms.kinds();
}

std::string_view to_string(phantom_kind k) noexcept
{
    return phantoms.name(k);
}

template <>
phantom_kind from_string<phantom_kind>(std::string_view name)
{
    return phantoms.kind(name);
}

template <>
std::span<const phantom_kind> values_of<phantom_kind>() noexcept
{
    return phantoms.kinds();
}

std::string_view to_string(start_from_kind k) noexcept
{
    return start_froms.name(k);
}

template <>
start_from_kind from_string<start_from_kind>(std::string_view name)
{
    return start_froms.kind(name);
}

template <>
std::span<const start_from_kind> values_of<start_from_kind>() noexcept
{
    return start_froms.kinds();
}

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
