// SPDX-License-Identifier: MIT
/// \file
/// Descriptions of values by their members. A template members(io, value) names each member once, with its
/// meaning. The io writes the members, reads them or makes a schema.
#pragma once

#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/bounds.hpp"

namespace tactor::detail {

/// Concept for a type that is Value or const Value.
template <class T, class Value>
concept either = std::same_as<std::remove_const_t<T>, Value>;

inline constexpr bounds any_number{-std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::infinity()};
inline constexpr bounds from_0{0.0, std::numeric_limits<double>::infinity()};
inline constexpr bounds above_0{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr bounds up_to_0{-std::numeric_limits<double>::infinity(), 0.0};

/// Meaning of a member, in the manual's words, and the bounds of the member's numbers.
struct about {
    const char* text;
    bounds range = any_number;
};

/// Returns the text, or nothing if it is empty.
inline std::optional<std::string> omit_empty(const std::string& text)
{
    return text.empty() ? std::nullopt : std::optional(text);
}

/// Returns the value, or nothing if it is equal to the usual one.
template <class T>
std::optional<T> omit_usual(const T& v, const T& usual)
{
    return v == usual ? std::nullopt : std::optional(v);
}

/// Describes a member that is left out if it has the usual value.
template <class Io, class T>
void describe_unless_usual(Io& io, const char* name, T& v, const std::remove_const_t<T>& usual,
                           const about& what)
{
    io.describe_converted(
        name, omit_usual(v, usual), [&v](const auto& read) { v = read.value_or(v); }, what);
}

/// A member that is always present, and null if it has no value. Other optional members are left out if they
/// have no value.
template <class T>
struct nullable {
    std::optional<T> value = {};
};

/// Values with names that are known only at run time, such as the names of a study's motions.
template <class T>
struct by_name {
    std::vector<std::pair<std::string, T>> all = {};
};

} // namespace tactor::detail
