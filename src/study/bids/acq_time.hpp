// SPDX-License-Identifier: MIT
/// \file
/// Times of day as BIDS has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tactor::study {

/// "2026-11-21T14:03:00.123456Z": UTC, whole microseconds, from ns since 1970.
std::string acq_time_text(std::int64_t utc_ns);

/// Reads such a text, with or without the Z. Returns nothing for any other text.
std::optional<std::int64_t> acq_time_ns(const std::string& text);

/// CLOCK_REALTIME.
std::int64_t utc_now_ns() noexcept;

} // namespace tactor::study
