// SPDX-License-Identifier: MIT
/// \file
/// A D-Bus daemon of the test's own, and programs on it, which answer in threads of their own.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include <sys/types.h>

struct sd_bus;
struct sd_bus_message;

namespace tactor::test {

/// A daemon. This process has it as its system bus and its session bus; none after the destructor.
class private_bus {
public:
    private_bus();
    ~private_bus();
    private_bus(const private_bus&) = delete;
    private_bus& operator=(const private_bus&) = delete;

    void end();

private:
    std::string config_;
    pid_t daemon_ = -1;
};

/// A connection of another program.
class peer {
public:
    /// Handler of the method calls for an object. Returns 0 for a call that it does not know.
    using handler = std::function<int(sd_bus_message*)>;

    peer();
    ~peer();
    peer(const peer&) = delete;
    peer& operator=(const peer&) = delete;

    /// Takes a name, which others may replace, and answers calls for the object at `path`, in another thread,
    /// until the destructor.
    void serve(const std::string& name, const std::string& path, handler h);
    /// Gives a name up. A handler may call it.
    void release(const std::string& name);

    /// Calls below: without serve().
    /// Returns the name of the owner of a name: that of a connection, or an empty one.
    std::string owner(const std::string& name);
    /// Calls RequestRelease of a card. Returns its answer; -1 for an error.
    int request_release(const std::string& name, const std::string& path, int priority);
    /// Returns a property of a card as text; empty for an error.
    std::string property(const std::string& name, const std::string& path, const char* property, char type);

    std::string own_name() const;

private:
    sd_bus* bus_ = nullptr;
    std::atomic<bool> ends_ = false;
    std::thread thread_;
    handler handler_;
};

} // namespace tactor::test
