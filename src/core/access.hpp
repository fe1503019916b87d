// SPDX-License-Identifier: MIT
/// \file
/// Access of the library to the contents of its public classes, and construction of these classes from
/// contents.
#pragma once

#include <utility>

#include <tactor/api.hpp>

namespace tactor::detail {

struct access {
    /// Returns the contents of a path, trajectory, layout or score.
    template <typename T>
    static const auto& of(const T& t) noexcept
    {
        return *t.impl_;
    }
    template <typename T>
    static const auto& shared(const T& t) noexcept
    {
        return t.impl_;
    }
    template <typename T, typename Impl>
    static T make(Impl p)
    {
        return T(std::move(p));
    }
};

} // namespace tactor::detail
