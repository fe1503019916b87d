// SPDX-License-Identifier: MIT
/// \file
/// Owners of what C libraries hand out.
#pragma once

namespace tactor::detail {

/// For std::unique_ptr<T, deleter<function>>.
template <auto Free>
struct deleter {
    template <typename T>
    void operator()(T* p) const noexcept
    {
        Free(p);
    }
};

} // namespace tactor::detail
