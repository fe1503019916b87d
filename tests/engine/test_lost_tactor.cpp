// SPDX-License-Identifier: MIT
// Wiring: each tactor needs a channel of the device to itself.
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>

namespace lost_tactor_test {

using namespace tactor;

namespace {

array line_of_three()
{
    return make_grid("line", 1, 3, 20.0, 20.0);
}

std::string lost(std::vector<std::vector<unsigned>> outputs)
{
    return lost_tactor(line_of_three(), {.outputs = std::move(outputs)});
}

} // namespace

TEST_CASE("a tactor is lost when its channel reaches nothing, or nothing by itself")
{
    CHECK(lost({}).empty());
    CHECK(lost({{2}, {0}, {1}}).empty());
    CHECK(lost({{0, 3}, {1}, {2, 4}}).empty());
    CHECK(lost({{0, 1}, {1, 2}, {2, 3}}) == "tactor 1 of line is on channel 1, which reaches the device only "
                                            "together with channel 0 of tactor 0");
    CHECK(lost({{0}, {}, {2}}) == "tactor 1 of line is on channel 1, which reaches no channel of the device");
    CHECK(lost({{5}, {1}, {5}}) == "tactor 0 of line is on channel 0, which reaches the device only together "
                                   "with channel 2 of tactor 2");
    CHECK(lost({{0}, {1}}) == "tactor 2 of line is on channel 2, which reaches no channel of the device");
    // Channels without a tactor may share.
    CHECK(lost({{0}, {1}, {2}, {2}, {}}).empty());
    CHECK(lost_tactor(line_of_three(), {.hidden_by = "type pulse"}).empty());
}

TEST_CASE("a tactor that arrives louder is refused, other changes are warned of")
{
    stream_wiring w{.outputs = {{0}, {1}, {2, 3}}, .gains = {{1.0}, {-0.5}, {1.0, 0.1}}};
    CHECK(lost_tactor(line_of_three(), w).empty());
    CHECK(wiring_warnings(line_of_three(), w) ==
          std::vector<std::string>{
              "tactor 1 of line is on channel 1, which ALSA's configuration plays at -6.02 dB with its "
              "polarity reversed",
              "tactor 2 of line is on channel 2, which reaches 2 channels of the device, at 0 dB, -20 dB"});
    w.gains[1] = {-2.0};
    CHECK(lost_tactor(line_of_three(), w) ==
          "tactor 1 of line is on channel 1, which ALSA's configuration plays at 6.02 dB with its polarity "
          "reversed: louder than its limit allows");
    CHECK(wiring_warnings(line_of_three(), {}).empty());
    CHECK(wiring_warnings(line_of_three(), {.most_gain = 2.0}) ==
          std::vector<std::string>{
              "ALSA's configuration raises samples by up to 6.02 dB on the way to the device, "
              "and clips them there at full scale"});
    CHECK(wiring_warnings(line_of_three(), {.level_by = "type softvol"}) ==
          std::vector<std::string>{"a mixer control sets the level of all tactors: type softvol is between"});
}

TEST_CASE("a player refuses an array of which a tactor is lost")
{
    alsa_options o{.pcm = "t",
                   .channels = 3,
                   .config_text = "pcm.n { type null }\n"
                                  "pcm.t { type route slave.pcm n ttable { 0.0 1 2.1 1 } }"};
    try {
        const player p(open_alsa(o), line_of_three());
        FAIL("it opened");
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::not_available);
        CHECK(std::string(e.what()) ==
              "stream on \"t\": tactor 1 of line is on channel 1, which reaches no channel of the device "
              "(give each channel one of the device's, at 1, where the PCM is defined (ttable, bindings), or "
              "play on the card itself, hw:CARD=NAME)");
    }
    array two = line_of_three();
    two.tactors.erase(two.tactors.begin() + 1);
    CHECK_NOTHROW(player(open_alsa(o), two));
}

TEST_CASE("wiring that hides the channels' routes is logged, and plays")
{
    std::string said;
    alsa_options o{.pcm = "t",
                   .channels = 3,
                   .config_text = "pcm.n { type null }\n"
                                  "pcm.t { type route slave.pcm n ttable { 0.FL 1 } }"};
    o.log = [&](log_kind k, std::string_view text) {
        if (k == log_kind::warning)
            said += text;
    };
    CHECK_NOTHROW(player(open_alsa(o), line_of_three()));
    CHECK(said == "PCM \"t\": which of the device's channels its own reach is not known: type route to a "
                  "channel FL is between");
}

} // namespace lost_tactor_test
