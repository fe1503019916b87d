// SPDX-License-Identifier: MIT
// Lines that outlive the players that they are lent to.
#include "session/lines.hpp"

#include <memory>

#include <doctest/doctest.h>

namespace lines_test {

using namespace tactor;
using session::amplifier_state;

namespace {

class line final : public enable_line {
public:
    line(bool& on, const bool& stuck) : on_(on), stuck_(stuck) {}
    bool set(bool on) noexcept override
    {
        if (stuck_)
            return false;
        on_ = on;
        return true;
    }

private:
    bool& on_;
    const bool& stuck_;
};

struct lent {
    bool on = false;
    bool stuck = false;
    int switched = 0;
    session::lent_lines lines{{.amplifier = std::make_unique<line>(on, stuck)}};

    lent()
    {
        lines.on_switch([this] { ++switched; });
    }
};

} // namespace

TEST_CASE("without an amplifier there is none to be on")
{
    const session::lent_lines none;
    CHECK(none.lend().amplifier == nullptr);
    CHECK(none.amplifier() == amplifier_state::none);
    CHECK(to_string(none.amplifier()) == "none");
}

TEST_CASE("an amplifier is muted once the player that has it had switched it on")
{
    lent l;
    const player_lines first = l.lines.lend(0.5);
    CHECK(first.proof_s == 0.5);
    CHECK(l.lines.amplifier() == amplifier_state::off);
    CHECK(first.amplifier->set(true));
    CHECK(l.on);
    CHECK(l.lines.amplifier() == amplifier_state::on);
    CHECK(first.amplifier->set(false));
    CHECK(first.amplifier->set(false));
    CHECK(l.lines.amplifier() == amplifier_state::muted);
    CHECK(to_string(l.lines.amplifier()) == "off");
    CHECK(l.switched == 2);
    const player_lines next = l.lines.lend();
    CHECK(l.lines.amplifier() == amplifier_state::off);
}

TEST_CASE("a player that is gone leaves the amplifier off")
{
    lent l;
    CHECK(l.lines.lend().amplifier->set(true));
    CHECK_FALSE(l.on);
    CHECK(l.lines.amplifier() == amplifier_state::muted);
}

TEST_CASE("an amplifier that refuses to go off counts as on, also for the next player")
{
    lent l;
    {
        const player_lines lost = l.lines.lend();
        CHECK(lost.amplifier->set(true));
        l.stuck = true;
        CHECK_FALSE(lost.amplifier->set(false));
    }
    CHECK(l.lines.amplifier() == amplifier_state::on);
    const player_lines next = l.lines.lend();
    CHECK(l.lines.amplifier() == amplifier_state::on);
}

} // namespace lines_test
