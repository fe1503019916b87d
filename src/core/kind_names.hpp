// SPDX-License-Identifier: MIT
/// \file
/// Names of an enumeration's values: a macro that defines them, and functions that list them for readers with
/// their own messages about unknown names.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/api.hpp>
#include <tactor/error.hpp>

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

/// Names of an enumeration, in the order of declaration. `what` names the enumeration in messages.
template <typename Kind, std::size_t N>
struct kind_table {
    std::string_view what;
    std::array<Kind, N> kinds{};
    std::array<std::string_view, N> names{};

    constexpr std::string_view name(Kind k) const noexcept
    {
        const auto at = static_cast<std::size_t>(std::find(kinds.begin(), kinds.end(), k) - kinds.begin());
        return at < N ? names[at] : "unknown";
    }

    Kind kind(std::string_view name) const
    {
        const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        if (at < N)
            return kinds[at];
        throw error(error_kind::bad_input, what, fmt::format("\"{}\" is unknown", name),
                    fmt::format("use one of {}", fmt::join(names, ", ")))
            .with_field(what);
    }
};

template <typename Kind, std::size_t N>
constexpr kind_table<Kind, N> make_kind_table(std::string_view what,
                                              const std::pair<Kind, std::string_view> (&all)[N]) noexcept
{
    kind_table<Kind, N> table{what};
    for (std::size_t i = 0; i < N; ++i) {
        table.kinds[i] = all[i].first;
        table.names[i] = all[i].second;
    }
    return table;
}

} // namespace tactor::detail

/// Defines the functions that TACTOR_KIND declares, inside namespace tactor::v0. `what` names the enumeration
/// in messages. The values and their names follow in the order of declaration.
#define TACTOR_KIND_NAMES(Kind, what, ...)                                                                   \
    namespace {                                                                                              \
    constexpr auto Kind##_names = [] {                                                                       \
        using enum Kind;                                                                                     \
        return detail::make_kind_table<Kind>(what, {__VA_ARGS__});                                           \
    }();                                                                                                     \
    }                                                                                                        \
    std::string_view to_string(Kind k) noexcept                                                              \
    {                                                                                                        \
        return Kind##_names.name(k);                                                                         \
    }                                                                                                        \
    template <>                                                                                              \
    Kind from_string<Kind>(std::string_view name)                                                            \
    {                                                                                                        \
        return Kind##_names.kind(name);                                                                      \
    }                                                                                                        \
    template <>                                                                                              \
    std::span<const Kind> all_values<Kind>() noexcept                                                        \
    {                                                                                                        \
        return Kind##_names.kinds;                                                                           \
    }                                                                                                        \
    static_assert(true)
