// SPDX-License-Identifier: MIT
/// \file
/// The names of an enumeration's values, once.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/kinds.hpp>

namespace tactor::detail {

template <typename Kind>
struct kind_name {
    Kind kind;
    std::string_view name;
};

/// `what` stands for it in messages. Names in the order of declaration.
template <typename Kind, std::size_t N>
class kind_table {
public:
    constexpr kind_table(std::string_view what, const kind_name<Kind> (&all)[N]) noexcept : what_(what)
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
        throw error(error_kind::bad_input, what_, fmt::format("\"{}\" is not known", name), "one of " + all);
    }

    constexpr const std::array<Kind, N>& kinds() const noexcept { return kinds_; }

private:
    std::string_view what_;
    std::array<Kind, N> kinds_{};
    std::array<std::string_view, N> names_{};
};

} // namespace tactor::detail

/// Defines to_string(), from_string() and values_of() of a kind, inside namespace tactor::v0, by its table.
#define TACTOR_KIND_FUNCTIONS(Kind, table)                                                                   \
    std::string_view to_string(Kind k) noexcept                                                              \
    {                                                                                                        \
        return (table).name(k);                                                                              \
    }                                                                                                        \
    template <>                                                                                              \
    Kind from_string<Kind>(std::string_view name)                                                            \
    {                                                                                                        \
        return (table).kind(name);                                                                           \
    }                                                                                                        \
    template <>                                                                                              \
    std::span<const Kind> values_of<Kind>() noexcept                                                         \
    {                                                                                                        \
        return (table).kinds();                                                                              \
    }
