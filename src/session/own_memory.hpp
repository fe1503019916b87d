// SPDX-License-Identifier: MIT
/// \file
/// Real-time settings of the process, which the tool may change and the library may not.
#pragma once

#include <cstdint>
#include <string>

namespace tactor::session {

/// Locks all memory of the process, now and to come, and lets the kernel end the process if a real-time
/// thread runs for 0.2 s without a pause: it would block a computer with one core for good. Call it before
/// threads are made and after the last fork. Returns true if memory is locked. \throws error (not_available)
/// if it is not, and `required`.
bool settle_realtime(bool required);

/// Returns how much settle_realtime() would lock now, with what threads will need.
std::uint64_t memory_to_lock();

/// Lets the heap give back what is freed, for a process that lives long and whose clients come and go: large
/// blocks are mapped one by one. Call it after settle_realtime(), which keeps all.
void give_memory_back();

/// Warns on standard error if the audio thread has no real-time priority or its memory is not locked.
void warn_of_rights(bool realtime, bool locked);

} // namespace tactor::session
