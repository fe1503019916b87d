// SPDX-License-Identifier: MIT
/// \file
/// Rights that a desktop grants by D-Bus: real-time priority, a card that a sound server holds, and a delay
/// before the system sleeps. A missing bus or service is not an error: it grants nothing. Each call waits a
/// second at most for an answer.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <sys/types.h>

namespace tactor::desktop {

/// Asks RealtimeKit, on the system bus, to give a thread of this process SCHED_FIFO. The priority is at most
/// the one that RealtimeKit allows. Lowers the process's RLIMIT_RTTIME to the limit that RealtimeKit demands.
/// Returns true if the thread has got the priority.
bool request_realtime(pid_t thread, int priority) noexcept;

/// A sound card that this process has reserved on the session bus (ReserveDevice1): sound servers leave it
/// alone until the object is destroyed.
class reservation {
public:
    /// Priority of tactor: above PulseAudio (0) and WirePlumber (-20), below JACK (2147483647).
    static constexpr int priority = 100;

    /// Asks the program that has reserved a card to release it, and then reserves the card. Returns null if
    /// no program has reserved the card, or if the program refuses. `holder`: receives the program's name, if
    /// known; the name can be any text. `give_up`: called in another thread when a program with a higher
    /// priority asks for the card. If it returns true, it promises that this object will be destroyed soon.
    /// Null: keeps the card.
    static std::unique_ptr<reservation> take(unsigned card_index, std::function<bool()> give_up,
                                             std::string& holder);
    /// Gives the card back, and agrees to a request that waits. Close the card first.
    ~reservation();
    reservation(const reservation&) = delete;
    reservation& operator=(const reservation&) = delete;

private:
    struct impl;
    explicit reservation(std::unique_ptr<impl> i);

    std::unique_ptr<impl> impl_;
};

/// Watch of the system's sleep (logind's PrepareForSleep). While the system is awake, holds a lock that
/// delays sleep. Without logind, it does nothing.
class sleep_watch {
public:
    /// `change`: called in another thread with true before the system sleeps, and with false when it has
    /// woken. The system sleeps when `change` has returned, after 5 s at the latest (InhibitDelayMaxSec of
    /// logind.conf). Must not throw.
    explicit sleep_watch(std::function<void(bool asleep)> change);
    ~sleep_watch();
    sleep_watch(const sleep_watch&) = delete;
    sleep_watch& operator=(const sleep_watch&) = delete;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor::desktop
