// SPDX-License-Identifier: MIT
/// \file
/// Contact bounce, taken out by the edges' own time stamps.
#pragma once

#include <cstdint>
#include <optional>

namespace tactor::gpio {

/// Drops every edge that follows another, dropped or not, within the window: the first edge of a burst
/// passes at its own time and the rest of the burst does not, however long it lasts.
class debounce {
public:
    explicit debounce(std::int64_t window_ns) : window_ns_(window_ns) {}

    bool accepts(std::int64_t time_ns) noexcept
    {
        const bool apart = !last_ns_ || time_ns - *last_ns_ >= window_ns_;
        last_ns_ = time_ns;
        return apart;
    }

private:
    std::int64_t window_ns_;
    std::optional<std::int64_t> last_ns_ = {};
};

} // namespace tactor::gpio
