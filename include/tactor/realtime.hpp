// SPDX-License-Identifier: MIT
/// \file
/// Whether this process may work in real time, and how it gets the right.
#pragma once

#include <cstdint>
#include <optional>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// What limits and capabilities allow.
struct realtime_rights {
    int priority = 0; ///< highest SCHED_FIFO priority that may be asked for; 0: none
    /// Bytes of memory that may be locked; none: no limit.
    std::optional<std::uint64_t> lockable_bytes = 0;
};

/// Of this process, now. The library asks for priorities itself and never locks the memory of its host. No
/// files are read; does not block.
[[nodiscard]] TACTOR_API realtime_rights probe_realtime_rights() noexcept;

} // namespace v0
} // namespace tactor
