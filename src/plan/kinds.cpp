// SPDX-License-Identifier: MIT
#include <tactor/plan.hpp>

#include "core/kind_table.hpp"

namespace tactor {
inline namespace v0 {
namespace {

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

} // namespace

std::string_view to_string(timing_kind k) noexcept
{
    return timings.name(k);
}

template <>
timing_kind from_string<timing_kind>(std::string_view name)
{
    return timings.kind(name);
}

template <>
std::span<const timing_kind> values_of<timing_kind>() noexcept
{
    return timings.kinds();
}

std::string_view to_string(outside_kind k) noexcept
{
    return outsides.name(k);
}

template <>
outside_kind from_string<outside_kind>(std::string_view name)
{
    return outsides.kind(name);
}

template <>
std::span<const outside_kind> values_of<outside_kind>() noexcept
{
    return outsides.kinds();
}

std::string_view to_string(overlap_kind k) noexcept
{
    return overlaps.name(k);
}

template <>
overlap_kind from_string<overlap_kind>(std::string_view name)
{
    return overlaps.kind(name);
}

template <>
std::span<const overlap_kind> values_of<overlap_kind>() noexcept
{
    return overlaps.kinds();
}

std::string_view to_string(scale_kind k) noexcept
{
    return scales.name(k);
}

template <>
scale_kind from_string<scale_kind>(std::string_view name)
{
    return scales.kind(name);
}

template <>
std::span<const scale_kind> values_of<scale_kind>() noexcept
{
    return scales.kinds();
}

} // namespace v0
} // namespace tactor
