// SPDX-License-Identifier: MIT
#include "private_bus.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

namespace tactor::test {
namespace {

constexpr const char* card_interface = "org.freedesktop.ReserveDevice1";

// No service of this machine can be started on it.
constexpr const char* configuration = R"(<busconfig><type>session</type><listen>unix:tmpdir=/tmp</listen>
<auth>EXTERNAL</auth><policy context="default"><allow send_destination="*" eavesdrop="true"/>
<allow eavesdrop="true"/><allow own="*"/></policy></busconfig>)";

int require_valid(int result, const char* what)
{
    if (result < 0)
        throw std::runtime_error(std::string(what) + ": " + std::to_string(-result));
    return result;
}

void use_as_buses(const std::string& address)
{
    ::setenv("DBUS_SYSTEM_BUS_ADDRESS", address.c_str(), 1);
    ::setenv("DBUS_SESSION_BUS_ADDRESS", address.c_str(), 1);
}

} // namespace

private_bus::private_bus()
{
    config_ = (std::filesystem::temp_directory_path() / "tactor-bus-XXXXXX").string();
    ::close(::mkstemp(config_.data()));
    std::ofstream(config_) << configuration;
    std::array<int, 2> ends{};
    require_valid(::pipe(ends.data()), "pipe");
    const std::string file = "--config-file=" + config_;
    std::array<char*, 5> arguments{const_cast<char*>("dbus-daemon"), const_cast<char*>(file.c_str()),
                                   const_cast<char*>("--nofork"), const_cast<char*>("--print-address=1"),
                                   nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    // It says that it cannot have more descriptors.
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int code = ::posix_spawnp(&daemon_, "dbus-daemon", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    require_valid(-code, "dbus-daemon");
    std::string address;
    for (char letter = 0; ::read(ends[0], &letter, 1) == 1 && letter != '\n';)
        address += letter;
    ::close(ends[0]);
    use_as_buses(address);
}

private_bus::~private_bus()
{
    end();
    std::filesystem::remove(config_);
    use_as_buses("unix:path=/nowhere");
}

void private_bus::end()
{
    if (daemon_ < 0)
        return;
    ::kill(daemon_, SIGKILL);
    ::waitpid(daemon_, nullptr, 0);
    daemon_ = -1;
}

peer::peer()
{
    require_valid(sd_bus_open_user(&bus_), "sd_bus_open_user");
}

peer::~peer()
{
    ends_ = true;
    if (thread_.joinable())
        thread_.join();
    sd_bus_flush_close_unref(bus_);
}

void peer::serve(const std::string& name, const std::string& path, handler h)
{
    handler_ = std::move(h);
    require_valid(sd_bus_add_object(
                      bus_, nullptr, path.c_str(),
                      [](sd_bus_message* m, void* self, sd_bus_error*) {
                          return static_cast<peer*>(self)->handler_(m);
                      },
                      this),
                  "sd_bus_add_object");
    require_valid(sd_bus_request_name(bus_, name.c_str(), SD_BUS_NAME_ALLOW_REPLACEMENT),
                  "sd_bus_request_name");
    thread_ = std::thread([this] {
        constexpr std::uint64_t turn_us = 5000;
        while (!ends_ && sd_bus_process(bus_, nullptr) >= 0)
            sd_bus_wait(bus_, turn_us);
    });
}

void peer::release(const std::string& name)
{
    sd_bus_release_name(bus_, name.c_str());
}

std::string peer::owner(const std::string& name)
{
    sd_bus_message* reply = nullptr;
    const char* text = "";
    if (sd_bus_call_method(bus_, "org.freedesktop.DBus", "/org/freedesktop/DBus", "org.freedesktop.DBus",
                           "GetNameOwner", nullptr, &reply, "s", name.c_str()) >= 0)
        sd_bus_message_read(reply, "s", &text);
    const std::string found = text;
    sd_bus_message_unref(reply);
    return found;
}

int peer::request_release(const std::string& name, const std::string& path, int priority)
{
    sd_bus_message* reply = nullptr;
    int agreed = -1;
    if (sd_bus_call_method(bus_, name.c_str(), path.c_str(), card_interface, "RequestRelease", nullptr,
                           &reply, "i", priority) >= 0)
        sd_bus_message_read(reply, "b", &agreed);
    sd_bus_message_unref(reply);
    return agreed;
}

std::string peer::property(const std::string& name, const std::string& path, const char* property, char type)
{
    if (type == 's') {
        char* text = nullptr;
        sd_bus_get_property_string(bus_, name.c_str(), path.c_str(), card_interface, property, nullptr,
                                   &text);
        const std::string found = text != nullptr ? text : "";
        std::free(text);
        return found;
    }
    int number = 0;
    return sd_bus_get_property_trivial(bus_, name.c_str(), path.c_str(), card_interface, property, nullptr,
                                       type, &number) >= 0
               ? std::to_string(number)
               : "";
}

std::string peer::own_name() const
{
    const char* name = "";
    sd_bus_get_unique_name(bus_, &name);
    return name;
}

} // namespace tactor::test
