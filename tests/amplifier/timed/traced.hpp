// SPDX-License-Identifier: MIT
/// \file
/// A player and its holder, run under ptrace up to one system call of one of them, at which one or both are
/// killed.
#pragma once

#include <cstdint>
#include <functional>
#include <set>

#include <sys/types.h>

#include "core/owned.hpp"

namespace tactor::test {

enum class party { player, holder, both };

/// Outcome of a run.
struct killed {
    bool reached = false;     ///< the session was long enough to have that system call
    bool anybody = false;     ///< the victim was alive
    std::int64_t time_ns = 0; ///< CLOCK_MONOTONIC
};

/// Returns whether processes can be traced here; not where the kernel forbids it or qemu translates.
bool can_trace();

/// A run. `session` is the player's code, in any number of threads, or another program that it becomes; it
/// forks its holder, which is recognised as a grandchild.
class traced_session {
public:
    /// The system call of the player from which they are counted.
    enum class counts { all, with_holder };

    explicit traced_session(const std::function<void()>& session, counts from = counts::all);

    /// Stops `counted` at the entry of its system call number `nth`, from 0, kills `victim`, lets the others
    /// go untraced, and returns when all have ended.
    /// Calls `before` shortly before the kill.
    killed kill_at(
        party counted, unsigned nth, party victim, const std::function<void()>& before = [] {});

private:
    bool stopped_at_entry(pid_t pid, int status) const;
    void note_child(pid_t parent, int event);
    bool belongs_to(party who, pid_t pid) const;
    void strike(party victim, killed& k);
    void let_go(pid_t stopped);
    void wait_for_all();

    pid_t player_ = -1;
    pid_t between_ = -1; ///< the process that forks the holder and ends
    pid_t holder_ = -1;
    detail::owned_fd holder_fd_;
    detail::owned_fd go_;
    counts from_;
    std::set<pid_t> threads_; ///< of the player
    std::set<pid_t> traced_;
};

} // namespace tactor::test
