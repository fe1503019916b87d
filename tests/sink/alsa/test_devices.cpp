// SPDX-License-Identifier: MIT
// The list of PCMs on a system made of files, and properties of a PCM on the fake DAC.
#include "sink/alsa/devices/cards.hpp"

#include <algorithm>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "fake_dac.hpp"
#include "fake_system.hpp"

namespace devices_test {

using namespace tactor;

namespace {

pcm_info named(const std::vector<pcm_info>& all, const std::string& name)
{
    const auto same = [&](const pcm_info& p) { return p.name == name; };
    REQUIRE_MESSAGE(std::count_if(all.begin(), all.end(), same) == 1, name);
    return *std::find_if(all.begin(), all.end(), same);
}

} // namespace

TEST_CASE("each playback device of each card is listed by its card's id, cards first")
{
    const test::fake_system s;
    s.two_cards();
    const auto all = alsa::list(s.root(), {});
    REQUIRE(all.size() > 3);
    CHECK(all[0].name == "hw:CARD=Headphones,DEV=0");
    CHECK(all[0].description == "bcm2835 Headphones");
    CHECK(all[1].name == "hw:CARD=DAC8x,DEV=0");
    CHECK(all[1].description == "snd_rpi_hifiberry_dac8x, HifiBerry DAC8x");
    CHECK(all[2].name == "hw:CARD=DAC8x,DEV=3");
    for (std::size_t i = 0; i < all.size(); ++i)
        CHECK(all[i].hardware == (i < 3));
    const pcm_info null = named(all, "null");
    REQUIRE(null.opened);
    CHECK(null.can->rates_hz.most == no_limit);
    CHECK(null.can->period_frames.most == no_limit);
    CHECK(null.can->buffer_frames.most == no_limit);
}

TEST_CASE("a card's device that cannot be opened says why and stays in the list")
{
    const test::fake_system s;
    s.write("proc/asound/cards", " 7 [NoSuchCard     ]: none - none\n");
    s.write("proc/asound/pcm", "07-00: x : : playback 1\n");
    const auto all = alsa::list(s.root(), {});
    const pcm_info& p = named(all, "hw:CARD=NoSuchCard,DEV=0");
    CHECK(p.tried);
    CHECK_FALSE(p.opened);
    CHECK_FALSE(p.can.has_value());
    CHECK_FALSE(p.error.empty());
    CHECK(p.error.find("PCM \"") == std::string::npos);
}

TEST_CASE("each device has its own holders")
{
    const test::fake_system s;
    s.two_cards();
    s.process(812, "pipewire", "/dev/snd/pcmC2D3p");
    s.process(900, "arecord", "/dev/snd/pcmC2D0c");
    const auto all = alsa::list(s.root(), {});
    CHECK(named(all, "hw:CARD=DAC8x,DEV=0").holders.empty());
    const auto& holders = named(all, "hw:CARD=DAC8x,DEV=3").holders;
    REQUIRE(holders.size() == 1);
    CHECK(holders[0].pid == 812);
    CHECK(holders[0].program == "pipewire");
}

TEST_CASE("the wanted PCM is found under any of its names, and listed where nothing else lists it")
{
    const test::fake_system s;
    s.two_cards();
    for (const char* name : {"hw:2,3", "hw:DAC8x,3", "hw:CARD=DAC8x,DEV=3", "hw:CARD=2,DEV=3"}) {
        CAPTURE(name);
        const auto all = alsa::list(s.root(), alsa_options{.pcm = name, .channels = 8});
        CHECK(named(all, "hw:CARD=DAC8x,DEV=3").wanted);
        CHECK(std::count_if(all.begin(), all.end(), [](const pcm_info& p) { return p.wanted; }) == 1);
    }
    // A converting PCM is another PCM, on the same device.
    CHECK(named(alsa::list(s.root(), alsa_options{.pcm = "plughw:2,3", .channels = 8}), "plughw:2,3").wanted);
    const auto all = alsa::list(s.root(), alsa_options{.pcm = "nowhere", .channels = 8});
    CHECK(all.back().name == "nowhere");
    CHECK(all.back().wanted);
    CHECK_FALSE(all.back().opened);
}

TEST_CASE("impossible numbers of a PCM are refused")
{
    CHECK_THROWS_WITH_AS(list_pcms(alsa_options{.channels = 0}), doctest::Contains("channels out of range"),
                         error);
}

TEST_CASE("a PCM's properties are found without configuring it")
{
    test::fake_dac dac({.least_channels = 2, .most_channels = 64});
    pcm_info p;
    alsa::look_at(dac.pcm(), alsa_options{.channels = 9}, p);
    REQUIRE(p.can.has_value());
    REQUIRE(p.can->channels.size() == 1);
    CHECK(p.can->channels[0].least == 2);
    CHECK(p.can->channels[0].most == 64);
    CHECK(p.can->rates_hz.least == 48000);
    CHECK(p.can->rates_hz.most == 48000);
    CHECK(p.can->usual_rates_hz == std::vector{48000U});
    CHECK(p.can->formats == std::vector{format_kind::s32, format_kind::float32, format_kind::s16});
    CHECK(p.can->period_frames.least >= 1);
    CHECK(p.can->period_frames.most < no_limit);
    CHECK(p.can->periods.most >= p.can->periods.least);
    CHECK(p.can->buffer_frames.most <= (1U << 20) / 4);
    CHECK(p.misfit.empty());
    CHECK(snd_pcm_state(dac.pcm()) == SND_PCM_STATE_OPEN);
    CHECK(dac.prepares() == 0);

    for (const alsa_options& o : {alsa_options{.channels = 65}, alsa_options{.channels = 9, .rate = 44100},
                                  alsa_options{.channels = 9, .format = format_kind::s24_4}}) {
        pcm_info other;
        alsa::look_at(dac.pcm(), o, other);
        CHECK(other.opened);
        CHECK(other.misfit.find("refused: ") != std::string::npos);
    }
    snd_pcm_close(dac.pcm());
}

TEST_CASE("channel counts with gaps stay apart")
{
    test::fake_dac dac({.channel_counts = {2, 3, 8}});
    pcm_info p;
    alsa::look_at(dac.pcm(), alsa_options{.channels = 5}, p);
    REQUIRE(p.can->channels.size() == 2);
    CHECK(p.can->channels[0].least == 2);
    CHECK(p.can->channels[0].most == 3);
    CHECK(p.can->channels[1].least == 8);
    CHECK(p.can->channels[1].most == 8);
    CHECK(p.misfit.find("refused: channels") != std::string::npos);
    snd_pcm_close(dac.pcm());
}

} // namespace devices_test
