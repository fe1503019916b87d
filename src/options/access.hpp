// SPDX-License-Identifier: MIT
/// \file
/// Functions that set and get the members which rows of the table stand for.
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include <tactor/api.hpp>

#include "core/kind_names.hpp"
#include "options/option.hpp"

namespace tactor::options {

template <class T>
struct without_optional {
    using type = T;
};
template <class T>
struct without_optional<std::optional<T>> {
    using type = T;
};

template <class T>
void put_value(T& into, const value& v)
{
    using plain = typename without_optional<T>::type;
    if (std::holds_alternative<std::monostate>(v)) { // back to no value
        if constexpr (!std::is_same_v<plain, T>)
            into.reset();
        return;
    }
    if constexpr (std::is_same_v<plain, bool>)
        into = std::get<bool>(v);
    else if constexpr (std::is_enum_v<plain>)
        into = *detail::find_kind<plain>(std::get<std::string>(v));
    else if constexpr (std::is_same_v<plain, std::string>)
        into = std::get<std::string>(v);
    else
        into = static_cast<plain>(std::get<double>(v));
}

template <class T>
value make_value(const T& from)
{
    if constexpr (std::is_enum_v<T>)
        return std::string(to_string(from));
    else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>)
        return from;
    else
        return static_cast<double>(from);
}

template <class T>
value make_value(const std::optional<T>& from)
{
    return from ? make_value(*from) : value();
}

/// Reaches one member: `Member` is a function from wishes to a reference, and has no state.
template <class Member>
constexpr access reach(Member)
{
    return {[](wishes& w, const value& v) { put_value(Member{}(w), v); },
            [](const wishes& w) { return make_value(Member{}(w)); }};
}

} // namespace tactor::options
