// SPDX-License-Identifier: MIT
/// \file
/// The names of a closed set's values, for readers that say in their own words what they do not know.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>

namespace tactor::detail {

/// In the order of declaration.
template <typename Kind>
std::vector<std::string_view> names_of()
{
    std::vector<std::string_view> names;
    for (const Kind k : values_of<Kind>())
        names.push_back(to_string(k));
    return names;
}

/// Of that name, if there is one.
template <typename Kind>
std::optional<Kind> kind_named(std::string_view name)
{
    for (const Kind k : values_of<Kind>())
        if (to_string(k) == name)
            return k;
    return std::nullopt;
}

} // namespace tactor::detail
