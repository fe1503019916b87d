// SPDX-License-Identifier: MIT
/// \file
/// Definition of the name functions of an enumeration.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <tactor/api.hpp>
#include <tactor/error.hpp>

namespace tactor::detail {

template <typename Kind>
struct kind_name {
    Kind kind;
    std::string_view name;
};

/// Names of an enumeration, in the order of declaration. `what` names the enumeration in messages.
template <typename Kind, std::size_t N>
class kind_table {
public:
    constexpr kind_table(std::string_view what, const std::array<kind_name<Kind>, N>& all) noexcept
        : what_(what)
    {
        for (std::size_t i = 0; i < N; ++i) {
            kinds_[i] = all[i].kind;
            names_[i] = all[i].name;
        }
    }

    constexpr std::string_view name(Kind k) const noexcept
    {
        for (std::size_t i = 0; i < N; ++i)
            if (kinds_[i] == k)
                return names_[i];
        return "unknown";
    }

    Kind kind(std::string_view name) const
    {
        std::string all;
        for (std::size_t i = 0; i < N; ++i) {
            if (names_[i] == name)
                return kinds_[i];
            all += (all.empty() ? "" : ", ") + std::string(names_[i]);
        }
        throw error(error_kind::bad_input, what_, fmt::format("\"{}\" is not known", name), "one of " + all)
            .with_field(what_);
    }

    constexpr const std::array<Kind, N>& kinds() const noexcept { return kinds_; }

private:
    std::string_view what_;
    std::array<Kind, N> kinds_{};
    std::array<std::string_view, N> names_{};
};

} // namespace tactor::detail

/// Defines what TACTOR_KIND declares, inside namespace tactor::v0. `what` names the enumeration in messages.
/// Each value with its name follows, in the order of declaration.
#define TACTOR_KIND_NAMES(Kind, what, ...)                                                                   \
    namespace {                                                                                              \
    constexpr auto Kind##_names = [] {                                                                       \
        using enum Kind;                                                                                     \
        return detail::kind_table(what, std::to_array<detail::kind_name<Kind>>({__VA_ARGS__}));              \
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
        return Kind##_names.kinds();                                                                         \
    }                                                                                                        \
    static_assert(true)
