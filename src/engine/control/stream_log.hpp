// SPDX-License-Identifier: MIT
/// \file
/// Messages to the program's log about the counters of the stream. The audio thread itself writes none.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/render.hpp>
#include <tactor/report.hpp>

#include "engine/link.hpp"

namespace tactor::engine {

/// Log of the control thread. look() collects under the player's mutex; write() calls the function without
/// it.
class stream_log {
public:
    stream_log(log_function to, const link& l, const drive_limits& limits)
        : to_(std::move(to)), link_(l), limits_(limits)
    {
    }

    /// Returns true if there is a function. Without one the other members do nothing.
    bool on() const noexcept { return static_cast<bool>(to_); }
    const log_function& function() const noexcept { return to_; }

    /// Collects changes since the last look, at a CLOCK_MONOTONIC time.
    void look(const stream_status& s, std::int64_t now_ns) noexcept;
    /// Notes points of a live stroke above its level.
    void look_at_end(const stroke_report& r) noexcept;
    /// Notes once that the stream is over, and why. Empty: it was stopped in order.
    void end(const std::string& why) noexcept;
    void write() noexcept;

private:
    void add(log_kind k, std::string text);
    void look_at_stream(const stream_status& s);
    void look_at_amplifier(const stream_status& s);
    void look_at_limits();

    log_function to_;
    const link& link_;
    drive_limits limits_;
    std::vector<std::pair<log_kind, std::string>> lines_;

    std::uint64_t xruns_ = 0;
    std::uint64_t epoch_ = 1;
    bool given_up_ = false;
    bool asleep_ = false;
    bool ready_ = false;
    std::uint32_t mutes_ = 0;
    std::uint64_t stalls_ = 0;
    std::uint64_t off_failures_ = 0;
    bool stuck_ = false;
    std::uint64_t cut_ = 0;
    std::uint64_t limited_ = 0;
    std::uint64_t power_limited_ = 0;
    std::int64_t limits_logged_ns_ = 0;
    bool over_ = false;
};

} // namespace tactor::engine
