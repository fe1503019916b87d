// SPDX-License-Identifier: MIT
/// \file
/// Facts about the running library and this process: version, build, and rights to real-time work.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tactor/api.hpp>

/// Version of these headers. version() returns the version of the running library.
#define TACTOR_VERSION_MAJOR 0
#define TACTOR_VERSION_MINOR 1
#define TACTOR_VERSION_PATCH 0
/// Number to compare versions: TACTOR_VERSION >= TACTOR_VERSION_NUMBER(0, 2, 0).
#define TACTOR_VERSION_NUMBER(major, minor, patch) ((major)*1000000 + (minor)*1000 + (patch))
#define TACTOR_VERSION TACTOR_VERSION_NUMBER(TACTOR_VERSION_MAJOR, TACTOR_VERSION_MINOR, TACTOR_VERSION_PATCH)

// The whole library is in an inline namespace. A version 0.x that breaks programs renames it (for example
// v0_2), so that programs compiled for another version fail to link instead of misbehaving. Programs write
// tactor::.
namespace tactor {
inline namespace v0 {

/// Returns the version, "0.1.0".
[[nodiscard]] TACTOR_API const char* version() noexcept;

/// Returns facts for a bug report, as a few lines for people: how and with what the library was built, and
/// which version of its loops this processor runs. Any thread.
[[nodiscard]] TACTOR_API std::string build_facts();

/// Rights that limits and capabilities give this process.
struct realtime_rights {
    int priority = 0; ///< highest SCHED_FIFO priority that the process may request; 0: none
    /// Bytes of memory that the process may lock. None: no limit.
    std::optional<std::uint64_t> lockable_bytes = 0;
};

/// Returns the rights of this process now. The library requests priorities itself, but never locks the memory
/// of its host. Reads no files. Does not block.
[[nodiscard]] TACTOR_API realtime_rights probe_realtime_rights() noexcept;

} // namespace v0
} // namespace tactor
