// SPDX-License-Identifier: MIT
// Kept by a player: reports not yet taken, and the set-up of its stream.
#include <memory>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace player_keeps_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("of too many reports not yet taken, the oldest ends go")
{
    dac_player p;
    const score s = tone(0.01);
    const stroke_id first = p.submit(s, start_at::trigger());
    const stroke_id second = p.submit(s, start_at::trigger());
    CHECK(p.cancel(second));
    for (int i = 0; i < 4096; ++i)
        REQUIRE(p.cancel(p.submit(s, start_at::trigger())));
    CHECK(p.cancel(first));
    CHECK(p.wait(first).outcome() == wait_kind::ended);
    CHECK(p.wait(second).outcome() == wait_kind::taken);
}

namespace {

// Changes its set-up with each start, like a PCM that turns out to have no clock.
class changing_sink final : public forwarding_sink {
public:
    explicit changing_sink(std::unique_ptr<sink> s)
        : forwarding_sink(std::move(s)), setup_(forwarding_sink::setup())
    {
    }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind start() noexcept override
    {
        setup_.has_clock = !setup_.has_clock;
        return forwarding_sink::start();
    }

private:
    stream_setup setup_;
};

} // namespace

TEST_CASE("a player's set-up is that of the start, whatever the audio thread finds out later")
{
    fake_dac dac;
    auto changing = std::make_unique<changing_sink>(pcm::adopt(dac.pcm(), nine()));
    const stream_setup& own = changing->setup();
    player p(std::move(changing), palm(), patient());
    CHECK_FALSE(p.setup().has_clock);
    CHECK(&p.setup() != &own);
}

} // namespace player_keeps_test
