// SPDX-License-Identifier: MIT
/// \file
/// What stands behind a drive_history: a moment, and what was driven as of then.
#pragma once

#include <cstdint>

#include <tactor/player.hpp>

#include "synth/guard/drive_history.hpp"

namespace tactor {
inline namespace v0 {

struct drive_history::impl {
    synth::drive_history channels;
    std::int64_t taken_ns = 0; ///< CLOCK_MONOTONIC

    /// As of `now_ns`: what went by since counts as silence.
    synth::drive_history as_of(std::int64_t now_ns) const;
    /// As of now, and nothing is still to come.
    synth::drive_history until_now() const;
};

} // namespace v0
} // namespace tactor
