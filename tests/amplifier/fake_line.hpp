// SPDX-License-Identifier: MIT
/// \file
/// A line that is a pipe: each switch is a record with its time. And processes that play.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <sys/types.h>

#include "amplifier/holder.hpp"
#include "core/owned.hpp"

namespace tactor::test {

/// Limit for events that always come, however busy the machine is; longer is a hang.
inline constexpr int hangs_ms = 300'000;

/// Limits for tests without timing: however busy the machine is, no side gives the other up, and a line that
/// goes off meanwhile did not lapse.
inline constexpr amplifier::holder_limits patient{
    .silence_ms = 86'400'000, .answer_ms = hangs_ms, .start_ms = hangs_ms, .unanswered = 1'000'000};

/// Returns CLOCK_MONOTONIC in ns.
std::int64_t now_ns() noexcept;

struct switched {
    bool on = false;
    std::int64_t time_ns = 0;
};

class fake_line {
public:
    fake_line();
    fake_line(fake_line&&) = delete; // held() points into it

    amplifier::held_line held();
    /// Blocks until the line is switched, or for that long.
    std::optional<switched> next(int timeout_ms = hangs_ms) const;
    /// Makes switching on fail from now on. Call before the holder starts.
    void break_it() { state_.broken = true; }
    /// Makes the holder's first so many tries to switch off fail. Call before it starts.
    void refuse_off(int times) { state_.refusals = times; }

private:
    struct state {
        detail::owned_fd fd = {};
        bool broken = false;
        int refusals = 0;
    };
    static bool set(void* line, bool on) noexcept;

    state state_;
    detail::owned_fd read_;
};

/// A process with a holder and the line on. Killed when destroyed.
class player {
public:
    /// Code of the process once the line is on; it can send the test numbers.
    using body = std::function<void(amplifier::holder_link&, const std::function<void(int)>& tell)>;

    /// Starts the process, which calls `before` first. Blocks until the line is on.
    player(
        fake_line& line, const amplifier::holder_limits& limits, const body& b,
        const std::function<void()>& before = [] {});
    ~player();
    player(const player&) = delete;
    player& operator=(const player&) = delete;

    pid_t pid() const { return pid_; }
    pid_t holder() const { return holder_; }
    /// Returns the next number that it sends; -1 after the last.
    int told() const;
    /// Sends a signal and returns the time of it.
    std::int64_t signal(int number) const;

private:
    pid_t pid_ = -1;
    pid_t holder_ = -1;
    detail::owned_fd told_;
};

/// Beats every 50 ms for ever.
void keep_beating(amplifier::holder_link& h, const std::function<void(int)>& tell);

/// For a new process: no core file, and none of the handlers with which doctest reports a crash.
void die_quietly();

/// Longest time of a holder, ms: the promised one where it runs in real time, more where it may not.
std::int64_t promised_ms(pid_t holder);

/// Returns whether the process of a `pidfd` ends.
bool ends(const detail::owned_fd& pidfd);
detail::owned_fd open_pidfd(pid_t pid);

/// Returns a line of /proc/PID/status, without its name.
std::string read_status(pid_t pid, const std::string& field);

} // namespace tactor::test
