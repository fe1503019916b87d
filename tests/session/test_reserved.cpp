// SPDX-License-Identifier: MIT
// Devices on cards that a sound server holds.
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/sink.hpp>

#include "private_bus.hpp"
#include "session/device.hpp"
#include "session/device_stream.hpp"
#include "sound_server.hpp"

namespace reserved_test {

using namespace tactor;
using namespace tactor::test;
using manner = sound_server::manner;

namespace {

constexpr unsigned number = 3;
constexpr int highest = std::numeric_limits<std::int32_t>::max();

class device final : public paced_sink {
public:
    explicit device(std::function<void()> closed)
        : paced_sink({.name = "hw:3", .channels = 9, .rate = 48000, .format = format_kind::s16}),
          closed_(std::move(closed))
    {
    }
    ~device() override { closed_(); }
    device(const device&) = delete;
    device& operator=(const device&) = delete;
    io_kind take(std::uint64_t, std::span<const std::byte>) noexcept override { return io_kind::ok; }

private:
    std::function<void()> closed_;
};

/// A card that one program at a time opens.
struct card {
    std::atomic<bool> free = false;
    int tries = 0;
    std::function<void()> closed = [] {};
    session::card_claim claim = {};

    std::unique_ptr<sink> open(session::card_claim& c)
    {
        return session::open_on_card(
            [this]() -> std::unique_ptr<sink> {
                ++tries;
                if (!free)
                    throw error(error_kind::not_available, "PCM \"hw:3\"", "it is busy", "stop it")
                        .with_os_code(EBUSY);
                return std::make_unique<device>(closed);
            },
            number, c);
    }
    std::string refusal()
    {
        try {
            open(claim);
            return "";
        } catch (const error& e) {
            return e.what();
        }
    }
};

} // namespace

TEST_CASE("a card that is free is opened without a word to sound servers")
{
    const private_bus bus;
    const sound_server server(number, manner::agrees);
    card c{.free = true};
    CHECK(c.open(c.claim) != nullptr);
    CHECK(c.claim.holder.empty());
    CHECK(server.asked == 0);
}

TEST_CASE("a stream gets a busy card from its sound server, and closes it before it gives it back")
{
    const private_bus bus;
    card c;
    const sound_server server(number, manner::agrees, [&c] { c.free = true; });
    peer watcher;
    std::string owner;
    c.closed = [&] { owner = watcher.owner(card_name(number)); };
    session::stream_parts p;
    p.tactors = preset_array("palm-3x3");
    p.player.realtime = false;
    const auto claim = p.card;
    p.open = [&c, claim] { return c.open(*claim); };
    session::device_stream stream(std::move(p));
    stream.step();
    stream.run_work();
    CHECK(stream.state() == session::stream_state::running);
    CHECK(claim->holder == "Sound\\nServer");
    // Without news of strokes the stream keeps the card; between strokes it closes the card on request.
    CHECK(peer().request_release(card_name(number), card_path(number), highest) == 0);
    stream.set_busy(false);
    int answer = -1;
    std::thread other(
        [&answer] { answer = peer().request_release(card_name(number), card_path(number), highest); });
    while (stream.state() == session::stream_state::running) {
        stream.step();
        stream.run_work();
    }
    other.join();
    CHECK(answer == 1);
    CHECK(stream.state() == session::stream_state::idle);
    CHECK_FALSE(owner.empty()); // when the device was closed
    CHECK(owner != server.own_name());
    CHECK(watcher.owner(card_name(number)).empty());
}

TEST_CASE("an error says which program keeps a card when asked")
{
    const private_bus bus;
    card c;
    const sound_server server(number, manner::refuses);
    CHECK(c.refusal() == "PCM \"hw:3\": it is busy (Sound\\nServer did not give up the card: stop it)");
    CHECK(c.tries == 1);
    CHECK(server.asked != 0);
    card forbidden{.claim = {.ask = false}};
    CHECK(forbidden.refusal() == "PCM \"hw:3\": it is busy (stop it)");
    CHECK(forbidden.claim.holder.empty());
}

TEST_CASE("a card that stays busy, or cannot be opened at all, is given back")
{
    const private_bus bus;
    peer watcher;
    {
        card c;
        const sound_server server(number, manner::agrees); // another program has opened the card in between
        CHECK(c.refusal() == "PCM \"hw:3\": it is busy (stop it)");
        CHECK(c.tries > 1);
        CHECK(server.asked != 0);
        CHECK(watcher.owner(card_name(number)).empty());
    }
    const sound_server server(number, manner::agrees);
    session::card_claim claim;
    int tries = 0;
    CHECK_THROWS_AS(static_cast<void>(session::open_on_card(
                        [&tries]() -> std::unique_ptr<sink> {
                            throw error(error_kind::not_available, "PCM", "it fails")
                                .with_os_code(++tries == 1 ? EBUSY : ENODEV);
                        },
                        number, claim)),
                    error);
    CHECK(tries == 2);
    CHECK(watcher.owner(card_name(number)).empty());
}

} // namespace reserved_test
