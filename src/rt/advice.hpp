// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <tactor/version.hpp>

namespace tactor::rt {

/// Returns a sentence for people: what to do if the system refuses SCHED_FIFO at this priority, or memory of
/// this size.
std::string realtime_advice(const realtime_rights& r, int priority);

} // namespace tactor::rt
