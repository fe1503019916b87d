// SPDX-License-Identifier: MIT
// Requests to RealtimeKit and for cards, with doubles on a bus of the test's own.
#include "desktop/desktop.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <future>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "login_manager.hpp"
#include "private_bus.hpp"
#include "sound_server.hpp"

namespace desktop_test {

using namespace tactor;
using namespace tactor::test;
using manner = sound_server::manner;

namespace {

constexpr unsigned card = 7;
constexpr int highest = std::numeric_limits<std::int32_t>::max();
const std::string kit_name = "org.freedesktop.RealtimeKit1";
const std::string kit_path = "/org/freedesktop/RealtimeKit1";

/// RealtimeKit's methods, as its README describes them.
class realtime_kit {
public:
    explicit realtime_kit(int error = 0)
    {
        kit_.serve(kit_name, kit_path, [this, error](sd_bus_message* call) {
            if (sd_bus_message_is_method_call(call, "org.freedesktop.DBus.Properties", "Get") > 0) {
                const char* name = nullptr;
                sd_bus_message_read(call, "ss", nullptr, &name);
                return std::strcmp(name, "RTTimeUSecMax") == 0
                           ? sd_bus_reply_method_return(call, "v", "x", std::int64_t{150'000})
                           : sd_bus_reply_method_return(call, "v", "i", 20);
            }
            if (sd_bus_message_is_method_call(call, kit_name.c_str(), "MakeThreadRealtimeWithPID") <= 0)
                return 0;
            ::getrlimit(RLIMIT_RTTIME, &limit); // the caller is this process
            sd_bus_message_read(call, "ttu", &process, &thread, &priority);
            return error != 0 ? sd_bus_reply_method_errno(call, error, nullptr)
                              : sd_bus_reply_method_return(call, "");
        });
    }

    std::uint64_t process = 0;
    std::uint64_t thread = 0;
    std::uint32_t priority = 0;
    rlimit limit = {};

private:
    peer kit_;
};

std::unique_ptr<desktop::reservation> take(std::string& holder, std::function<bool()> give_up = {})
{
    return desktop::reservation::take(card, std::move(give_up), holder);
}

} // namespace

TEST_CASE("RealtimeKit gets the thread, a priority that it allows, and the limit that it wants")
{
    const private_bus bus;
    const realtime_kit kit;
    CHECK(desktop::request_realtime(4711, 65));
    CHECK(kit.process == static_cast<std::uint64_t>(::getpid()));
    CHECK(kit.thread == 4711);
    CHECK(kit.priority == 20);
    CHECK(kit.limit.rlim_max == 150'000);
    CHECK(kit.limit.rlim_cur <= 150'000);
    CHECK(desktop::request_realtime(4711, 5));
    CHECK(kit.priority == 5);
}

TEST_CASE("a refusal of RealtimeKit, no RealtimeKit and no bus grant nothing")
{
    {
        const private_bus bus;
        CHECK_FALSE(desktop::request_realtime(1, 65));
        const realtime_kit kit(EACCES);
        CHECK_FALSE(desktop::request_realtime(1, 65));
        CHECK(kit.priority == 20);
    }
    CHECK_FALSE(desktop::request_realtime(1, 65));
    std::string holder;
    CHECK(take(holder) == nullptr);
    CHECK(holder.empty());
}

TEST_CASE("a sound server that agrees gives its card up for as long as the reservation lasts")
{
    const private_bus bus;
    const sound_server server(card, manner::agrees);
    peer watcher;
    CHECK(watcher.owner(card_name(card)) == server.own_name());
    std::string holder;
    auto reserved = take(holder);
    REQUIRE(reserved != nullptr);
    CHECK(holder == "Sound\nServer");
    CHECK(server.asked == desktop::reservation::priority);
    const std::string owner = watcher.owner(card_name(card));
    CHECK_FALSE(owner.empty());
    CHECK(owner != server.own_name());
    CHECK(watcher.property(card_name(card), card_path(card), "ApplicationName", 's') == "tactor");
    CHECK(watcher.property(card_name(card), card_path(card), "Priority", 'i') ==
          std::to_string(desktop::reservation::priority));
    reserved.reset();
    CHECK(watcher.owner(card_name(card)).empty());
}

TEST_CASE("a sound server that refuses, or does not answer, keeps its card")
{
    for (const manner m : {manner::refuses, manner::silent}) {
        const private_bus bus;
        const sound_server server(card, m);
        const auto began = std::chrono::steady_clock::now();
        std::string holder;
        CHECK(take(holder) == nullptr);
        CHECK(holder == "Sound\nServer");
        CHECK(server.asked == desktop::reservation::priority);
        if (m == manner::silent)
            CHECK(std::chrono::steady_clock::now() - began >= std::chrono::seconds(1));
        CHECK(peer().owner(card_name(card)) == server.own_name());
    }
}

TEST_CASE("a card that no program has reserved is held by one that does not reserve cards")
{
    const private_bus bus;
    std::string holder;
    CHECK(take(holder) == nullptr);
    CHECK(holder.empty());
    peer watcher;
    while (!watcher.owner(card_name(card)).empty()) { // the daemon takes a moment to see that it is given up
    }
}

TEST_CASE("only a program with a higher priority gets the card, and only if the session agrees")
{
    const private_bus bus;
    const sound_server server(card, manner::agrees);
    std::atomic<int> asked = 0;
    std::atomic<bool> agrees = false;
    std::string holder;
    auto reserved = take(holder, [&] {
        ++asked;
        return agrees.load();
    });
    REQUIRE(reserved != nullptr);
    peer other;
    const auto ask = [&other](int priority) {
        return other.request_release(card_name(card), card_path(card), priority);
    };
    CHECK(ask(desktop::reservation::priority) == 0);
    CHECK(asked == 0);
    CHECK(ask(highest) == 0);
    CHECK(asked == 1);
    agrees = true;
    std::string owner_then = "?";
    std::future<int> answer = std::async(std::launch::async, [&] {
        const int a = ask(highest);
        owner_then = other.owner(card_name(card));
        return a;
    });
    while (asked < 2) {
    }
    CHECK(peer().request_release(card_name(card), card_path(card), highest) ==
          0); // promised to the first one
    CHECK(answer.wait_for(std::chrono::seconds(0)) == std::future_status::timeout);
    reserved.reset();
    CHECK(answer.get() == 1);
    CHECK(owner_then.empty());
}

TEST_CASE("a session without an answer of its own keeps the card")
{
    const private_bus bus;
    const sound_server server(card, manner::agrees);
    std::string holder;
    const auto reserved = take(holder);
    REQUIRE(reserved != nullptr);
    CHECK(peer().request_release(card_name(card), card_path(card), highest) == 0);
}

TEST_CASE("sleep waits until it has been acted on, and the next sleep does, too")
{
    const private_bus bus;
    login_manager login;
    std::promise<void> acted;
    std::atomic<int> began = 0;
    std::atomic<int> ended = 0;
    const desktop::sleep_watch watch([&](bool asleep) {
        ++(asleep ? began : ended);
        if (asleep && began == 1)
            acted.get_future().wait();
    });
    CHECK(login.locks == 1);
    login_manager::sleep(true);
    while (began == 0) {
    }
    CHECK(login.is_locked());
    acted.set_value();
    login.await_unlock();
    CHECK(ended == 0);
    login_manager::sleep(false);
    while (login.locks < 2) {
    }
    CHECK(ended == 1);
    CHECK(login.is_locked());
    login_manager::sleep(true);
    login.await_unlock();
    CHECK(began == 2);
}

TEST_CASE("without logind, or without a bus, nothing is watched")
{
    const auto never = [](bool) { CHECK(false); };
    {
        const private_bus bus;
        const desktop::sleep_watch watch(never);
    }
    const desktop::sleep_watch watch(never);
}

TEST_CASE("a watch whose bus has gone says that the system is awake")
{
    private_bus bus;
    std::atomic<int> calls = 0;
    std::atomic<bool> asleep = false;
    login_manager login;
    const desktop::sleep_watch watch([&](bool a) {
        asleep = a;
        ++calls;
    });
    login_manager::sleep(true);
    login.await_unlock();
    CHECK(asleep);
    bus.end();
    while (calls < 2) {
    }
    CHECK_FALSE(asleep);
}

TEST_CASE("a reservation ends in order when the bus has gone")
{
    private_bus bus;
    const sound_server server(card, manner::agrees);
    std::string holder;
    auto reserved = take(holder);
    REQUIRE(reserved != nullptr);
    bus.end();
    reserved.reset();
}

} // namespace desktop_test
