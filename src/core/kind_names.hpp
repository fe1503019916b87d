// SPDX-License-Identifier: MIT
/// \file
/// Names of a closed set's values, for readers with their own messages about unknown names.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>

namespace tactor::detail {

/// Returns the names in the order of declaration.
template <typename Kind>
std::vector<std::string_view> kind_names()
{
    std::vector<std::string_view> names;
    for (const Kind k : all_values<Kind>())
        names.push_back(to_string(k));
    return names;
}

/// Returns the value with that name, if any.
template <typename Kind>
std::optional<Kind> find_kind(std::string_view name)
{
    for (const Kind k : all_values<Kind>())
        if (to_string(k) == name)
            return k;
    return std::nullopt;
}

} // namespace tactor::detail
