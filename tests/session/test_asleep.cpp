// SPDX-License-Identifier: MIT
// An amplifier's line around the system's sleep.
#include "session/device_stream.hpp"

#include <atomic>
#include <memory>

#include <doctest/doctest.h>

#include "login_manager.hpp"
#include "private_bus.hpp"

namespace asleep_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// A line whose state the test sees.
class seen_line final : public enable_line {
public:
    explicit seen_line(std::atomic<bool>& is_on) : is_on_(is_on) {}
    bool set(bool on) noexcept override
    {
        is_on_ = on;
        return true;
    }

private:
    std::atomic<bool>& is_on_;
};

} // namespace

TEST_CASE("sleep waits until the amplifier's line is off; after it the line may be on")
{
    const private_bus bus;
    login_manager login;
    std::atomic<bool> is_on = false;
    session::lent_lines lines(
        {.amplifier = session::keep_off_while_asleep(std::make_unique<seen_line>(is_on))});
    const player_lines lent = lines.lend();
    CHECK_FALSE(lent.amplifier->must_be_off());
    CHECK(lent.amplifier->set(true));
    login_manager::sleep(true);
    while (!lent.amplifier->must_be_off()) {
    }
    CHECK(login.is_locked());
    CHECK(lent.amplifier->set(false));
    login.await_unlock();
    CHECK_FALSE(is_on);
    login_manager::sleep(false);
    while (lent.amplifier->must_be_off()) {
    }
    CHECK(lent.amplifier->set(true));
    CHECK(is_on);
}

TEST_CASE("a line that does not go off delays sleep for a second only")
{
    const private_bus bus;
    login_manager login;
    std::atomic<bool> is_on = false;
    const auto line = session::keep_off_while_asleep(std::make_unique<seen_line>(is_on));
    CHECK(line->set(true));
    login_manager::sleep(true);
    login.await_unlock();
    CHECK(is_on);
}

} // namespace asleep_test
