// SPDX-License-Identifier: MIT
/// \file
/// A login manager that announces sleep, and waits for the locks that delay it.
#pragma once

#include <atomic>
#include <cerrno>
#include <string>

#include <doctest/doctest.h>
#include <poll.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "private_bus.hpp"

namespace tactor::test {

/// logind's method Inhibit and signal PrepareForSleep. A method of its own, Sleep, makes it send the signal.
class login_manager {
public:
    login_manager()
    {
        login_.serve(name, path, [this](sd_bus_message* call) {
            if (sd_bus_message_is_method_call(call, manager, "Sleep") > 0) {
                int begins = 0;
                sd_bus_message_read(call, "b", &begins);
                sd_bus_emit_signal(sd_bus_message_get_bus(call), path, manager, "PrepareForSleep", "b",
                                   begins);
                return sd_bus_reply_method_return(call, "");
            }
            if (sd_bus_message_is_method_call(call, manager, "Inhibit") <= 0)
                return 0;
            const char* what = nullptr;
            const char* mode = nullptr;
            sd_bus_message_read(call, "ssss", &what, nullptr, nullptr, &mode);
            if (std::string(what) != "sleep" || std::string(mode) != "delay" || ::pipe(ends) != 0)
                return sd_bus_reply_method_errno(call, EINVAL, nullptr);
            const int sent = sd_bus_reply_method_return(call, "h", ends[1]);
            ::close(ends[1]);
            ++locks;
            return sent;
        });
    }

    /// Sends the signal.
    static void sleep(bool begins)
    {
        sd_bus* bus = nullptr;
        REQUIRE(sd_bus_open_user(&bus) >= 0);
        CHECK(sd_bus_call_method(bus, name, path, manager, "Sleep", nullptr, nullptr, "b", int{begins}) >= 0);
        sd_bus_flush_close_unref(bus);
    }
    /// Waits until the lock is given up.
    void await_unlock()
    {
        char c = 0;
        CHECK(::read(ends[0], &c, 1) == 0);
        ::close(ends[0]);
    }
    /// Returns true while the lock is held.
    bool is_locked() const
    {
        pollfd end{ends[0], 0, 0};
        return ::poll(&end, 1, 0) == 0;
    }

    std::atomic<int> locks = 0;

private:
    static constexpr const char* name = "org.freedesktop.login1";
    static constexpr const char* path = "/org/freedesktop/login1";
    static constexpr const char* manager = "org.freedesktop.login1.Manager";
    int ends[2] = {-1, -1}; // of the newest lock
    peer login_;
};

} // namespace tactor::test
