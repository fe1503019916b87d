// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include <tactor/version.hpp>

namespace tactor::rt {

/// What to do where SCHED_FIFO at this priority, or memory of this size, is refused: one sentence for
/// people.
std::string realtime_advice(const realtime_rights& r, int priority);

} // namespace tactor::rt
