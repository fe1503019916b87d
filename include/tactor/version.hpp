// SPDX-License-Identifier: MIT
/// \file
/// Facts about the library that runs and this process: version, build, and the right to work in real time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tactor/api.hpp>

/// Version of these headers; version() is that of the library that runs.
#define TACTOR_VERSION_MAJOR 0
#define TACTOR_VERSION_MINOR 1
#define TACTOR_VERSION_PATCH 0
/// For comparing: TACTOR_VERSION >= TACTOR_VERSION_NUMBER(0, 2, 0).
#define TACTOR_VERSION_NUMBER(major, minor, patch) ((major)*1000000 + (minor)*1000 + (patch))
#define TACTOR_VERSION TACTOR_VERSION_NUMBER(TACTOR_VERSION_MAJOR, TACTOR_VERSION_MINOR, TACTOR_VERSION_PATCH)

// All of tactor is in an inline namespace. A version 0.x that breaks programs renames it (v0_2, say): so
// programs that were compiled for another version do not link, instead of misbehaving. Programs say tactor::.
namespace tactor {
inline namespace v0 {

/// "0.1.0".
[[nodiscard]] TACTOR_API const char* version() noexcept;

/// Facts for a bug report about this library: how and with what it was built, and which of its loops this
/// processor runs. Some lines for people. Any thread.
[[nodiscard]] TACTOR_API std::string build_facts();

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
