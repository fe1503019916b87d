// SPDX-License-Identifier: MIT
/// \file
/// A line that is a pipe: each switch is a record with its own time. And processes that play.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <sys/types.h>

#include "amplifier/holder.hpp"

namespace tactor::test {

/// What is waited for comes, however busy the machine is; what does not come in so long hangs.
inline constexpr int hangs_ms = 300'000;

/// For what does not hang on time: however busy the machine is, nobody takes the other for lost, and a line
/// that goes off while a test waits did not do so for silence.
inline constexpr gpio::holder_limits patient{
    .silence_ms = 86'400'000, .answer_ms = hangs_ms, .start_ms = hangs_ms, .unanswered = 1'000'000};

/// CLOCK_MONOTONIC in ns.
std::int64_t now_ns() noexcept;

struct switched {
    bool on = false;
    std::int64_t time_ns = 0;
};

class fake_line {
public:
    fake_line();
    ~fake_line();
    fake_line(const fake_line&) = delete;
    fake_line& operator=(const fake_line&) = delete;

    gpio::held_line held();
    /// Blocks until the line is switched, or for that long.
    std::optional<switched> next(int timeout_ms = hangs_ms) const;
    /// From now on the line cannot be switched on. Before the holder starts.
    void break_it() { state_.broken = true; }
    /// The holder's first so many tries to switch off fail. Before it starts.
    void refuse_off(int times) { state_.refusals = times; }
    int descriptor() const { return state_.fd; }

private:
    struct state {
        int fd = -1;
        bool broken = false;
        int refusals = 0;
    };
    static bool set(void* line, bool on) noexcept;

    state state_;
    int read_ = -1;
};

/// A process with a holder and the line on. Killed when destroyed.
class player {
public:
    /// What the process does once the line is on; it can tell the test numbers.
    using body = std::function<void(gpio::holder_link&, const std::function<void(int)>& tell)>;

    /// `before` runs in the new process first. Blocks until the line is on.
    player(
        fake_line& line, const gpio::holder_limits& limits, const body& b,
        const std::function<void()>& before = [] {});
    ~player();
    player(const player&) = delete;
    player& operator=(const player&) = delete;

    pid_t pid() const { return pid_; }
    pid_t holder() const { return holder_; }
    /// What it told next; -1 when it tells nothing more.
    int told() const;
    /// Sends a signal and returns when that was.
    std::int64_t signal(int number) const;

private:
    pid_t pid_ = -1;
    pid_t holder_ = -1;
    int told_ = -1;
};

/// Beats every 50 ms for ever.
void keep_beating(gpio::holder_link& h, const std::function<void(int)>& tell);

/// The same, and another process has all of the player's descriptors: its number is told, and it waits to be
/// killed.
void keep_beating_with_a_child(gpio::holder_link& h, const std::function<void(int)>& tell);

/// For a new process: no core file, and none of the handlers with which doctest reports a crash.
void die_quietly();

/// How long a holder may take, in ms: what is promised where it runs in real time, more where it may not.
std::int64_t promised_ms(pid_t holder);

/// Whether a process ends. `pidfd` of it.
bool ends(int pidfd);
int open_pidfd(pid_t pid);

/// A line of /proc/PID/status, without its name.
std::string status_of(pid_t pid, const std::string& field);

} // namespace tactor::test
