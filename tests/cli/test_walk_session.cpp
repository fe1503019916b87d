// SPDX-License-Identifier: MIT
// A walk on a device whose clock the test moves: tactors that are not driven to their end.
#include "cli/check/check.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

#include <doctest/doctest.h>
#include <unistd.h>

#include "caught.hpp"
#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace walk_session_test {

using namespace tactor;
using namespace tactor::cli;
using namespace tactor::test;

namespace {

// Makes one xrun as soon as the first burst sounds; called again and again.
class stumble_once {
public:
    explicit stumble_once(fake_dac& d) : dac_(d) {}

    void operator()()
    {
        if (done_)
            return;
        const auto fresh = dac_.captured(seen_);
        seen_ = dac_.captured_frames();
        done_ = std::any_of(fresh.begin(), fresh.end(), [](auto b) { return b != std::byte{0}; });
        if (done_)
            dac_.advance(1'000'000);
    }

private:
    fake_dac& dac_;
    std::size_t seen_ = 0;
    bool done_ = false;
};

class answers {
public:
    explicit answers(const std::string& lines) : before_(::dup(STDIN_FILENO))
    {
        int ends[2];
        REQUIRE(::pipe(ends) == 0);
        REQUIRE(::write(ends[1], lines.data(), lines.size()) == static_cast<ssize_t>(lines.size()));
        ::dup2(ends[0], STDIN_FILENO);
        ::close(ends[0]);
        ::close(ends[1]);
    }
    ~answers()
    {
        ::dup2(before_, STDIN_FILENO);
        ::close(before_);
    }

private:
    int before_;
};

walk_result stumble(bool ask)
{
    fake_dac dac;
    environment e;
    e.tactors = make_grid("two", 1, 2, 20.0, 20.0);
    alsa_options device = nine();
    device.channels = 2;
    render_options r;
    r.channels = 2;
    const auto source = [&](session::stream_parts& p) {
        p.open = [&] { return alsa::adopt(dac.pcm(), device); };
        p.player = patient(p.player.limits);
        p.player.realtime = false;
    };
    const running_clock clock(dac, running_clock::capture_kind::kept, stumble_once(dac));
    check_options o;
    o.no_questions = !ask;
    return walk(device, {}, e, r, o, source);
}

} // namespace

TEST_CASE("a walk on which a tactor was not driven to its end fails at its end")
{
    const std::string said = caught_message([] { stumble(false); });
    CHECK(has(said, "tactor 0: interrupted: "));
    CHECK(has(said, "walk again"));
}

TEST_CASE("a walk whose tactor was driven again, to its end, succeeds")
{
    const answers a("r\n0\n1\n");
    CHECK(stumble(true).felt == session::walk_answers{0, 1});
}

} // namespace walk_session_test
