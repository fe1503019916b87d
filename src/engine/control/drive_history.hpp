// SPDX-License-Identifier: MIT
/// \file
/// The contents of a drive_history: how long channels were driven, as of one moment.
#pragma once

#include <cstdint>

#include <tactor/player.hpp>

#include "synth/guard/drive_history.hpp"

namespace tactor {
inline namespace v0 {

struct drive_history::impl {
    synth::drive_history channels;
    std::int64_t taken_ns = 0; ///< CLOCK_MONOTONIC

    /// As of `now_ns`: the time since `taken_ns` counts as silence, but for drives that were still to come.
    synth::drive_history as_of(std::int64_t now_ns) const;
    /// As of now, without the drives that are still to come.
    synth::drive_history until_now() const;
};

} // namespace v0
} // namespace tactor
