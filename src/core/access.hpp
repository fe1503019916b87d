// SPDX-License-Identifier: MIT
/// \file
/// How the library gets at what its public classes hold, and makes them from it.
#pragma once

#include <utility>

#include <tactor/api.hpp>

namespace tactor::detail {

struct access {
    /// What a path, trajectory, layout or score stands for.
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
