// SPDX-License-Identifier: MIT
#include "files/setup_layers.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <variant>

namespace tactor::detail {
namespace {

bool has_time_limits(const limit_settings& l)
{
    return l.max_drive_s || l.window_s;
}

// Returns true if the earlier value is a lower ceiling than the later one. A value that is not a number is
// kept, because a later check refuses it.
bool is_lower_ceiling(const written_value& earlier, const written_value& later)
{
    if (!earlier.name.starts_with("max_"))
        return false;
    const auto* before = std::get_if<double>(&earlier.value);
    const auto* after = std::get_if<double>(&later.value);
    return before == nullptr || (after != nullptr && *before <= *after);
}

} // namespace

std::optional<limit_settings> join_limits(const std::optional<limit_settings>& a,
                                          const std::optional<limit_settings>& b)
{
    if (!a || !b)
        return a ? a : b;
    limit_settings both = *a;
    if (b->power_dbfs)
        both.power_dbfs = std::min(*b->power_dbfs, a->power_dbfs.value_or(*b->power_dbfs));
    if (!has_time_limits(*b))
        return both;
    if (!has_time_limits(*a)) {
        both.max_drive_s = b->max_drive_s;
        both.window_s = b->window_s;
        return both;
    }
    both.max_drive_s =
        std::min(a->max_drive_s.value_or(usual_drive_s), b->max_drive_s.value_or(usual_drive_s));
    both.window_s = std::max(a->window_s.value_or(usual_window_s), b->window_s.value_or(usual_window_s));
    return both;
}

void add_default(std::vector<written_value>& all, written_value v)
{
    std::erase_if(all, [&v](const written_value& d) { return d.name == v.name; });
    all.push_back(std::move(v));
}

void join_serve(std::vector<written_value>& all, const std::vector<written_value>& later)
{
    std::vector<written_value> both;
    const auto replaced = [&later](const written_value& earlier) {
        return std::any_of(later.begin(), later.end(), [&earlier](const written_value& v) {
            return v.name == earlier.name && !is_lower_ceiling(earlier, v);
        });
    };
    std::remove_copy_if(all.begin(), all.end(), std::back_inserter(both), replaced);
    const std::size_t kept = both.size();
    for (const written_value& v : later)
        if (std::none_of(both.begin(), both.begin() + static_cast<std::ptrdiff_t>(kept),
                         [&v](const written_value& earlier) { return earlier.name == v.name; }))
            both.push_back(v);
    all = std::move(both);
}

} // namespace tactor::detail
