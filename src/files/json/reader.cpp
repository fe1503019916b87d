// SPDX-License-Identifier: MIT
#include "files/json/reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/suggest.hpp"

namespace tactor::files {
namespace {

// Returns "from 0 to 1", "above 0", "at most 0".
std::string range_text(const detail::bounds& range)
{
    const std::string low =
        std::isfinite(range.low) ? fmt::format("{} {}", range.above_low ? "above" : "from", range.low) : "";
    if (!std::isfinite(range.high))
        return low + (range.above_low ? "" : " on");
    if (low.empty() || range.above_low)
        return fmt::format("{}{}at most {}", low, low.empty() ? "" : " and ", range.high);
    return fmt::format("{} to {}", low, range.high);
}

} // namespace

void json_reader::finish() const
{
    for (const std::string& key : object_.keys())
        if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
            const std::string_view near = detail::nearest_name(key, known_);
            object_[key].refuse("is no field of it", near.empty() ? "" : detail::meant_name(key, near));
        }
}

double json_reader::number(const json_value& from, const detail::bounds& range)
{
    const double v = from.need_number();
    if (!range.holds(v))
        from.refuse(fmt::format("is {}, not {}", v, range_text(range)));
    return v;
}

double json_reader::whole(const json_value& from, const detail::bounds& range, bool is_unsigned, bool is_long)
{
    const double most = is_long ? 0x1p53 : 1e6;
    const double low = std::max(range.low, is_unsigned ? 0.0 : -most);
    const double high = std::min(range.high, most);
    const double v = from.need_number();
    if (!(v >= low && v <= high) || v != std::floor(v))
        from.refuse(fmt::format("is no whole number from {} to {}", low, high));
    return v;
}

} // namespace tactor::files
