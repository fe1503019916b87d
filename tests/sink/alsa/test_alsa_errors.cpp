// SPDX-License-Identifier: MIT
// Errors of ALSA and its library's messages.
#include <cerrno>
#include <cstdarg>
#include <filesystem>
#include <string>
#include <vector>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "caught.hpp"
#include "fake_system.hpp"
#include "has.hpp"
#include "sink/alsa/devices.hpp"
#include "sink/alsa/error_text.hpp"

namespace alsa_errors_test {

using namespace tactor;

namespace fs = std::filesystem;

namespace {

struct fake_system : test::fake_system {
    std::string says(const std::string& pcm, int code,
                     std::vector<std::string> pcms = {"default", "null"}) const
    {
        return says(pcm, code, "", {std::move(pcms), root()});
    }
    std::string leads(const std::vector<std::string>& route, int code, const std::string& detail = "") const
    {
        return says("default", code, detail, {{"default", "null"}, root(), route});
    }

private:
    static std::string says(const std::string& pcm, int code, const std::string& detail,
                            const alsa::surroundings& there)
    {
        const error e = alsa::open_error(pcm, code, detail, there);
        CHECK(e.kind() == error_kind::not_available);
        return e.what();
    }
};

} // namespace

TEST_CASE("a busy device names the programs that play on it, found by their descriptors")
{
    const fake_system s;
    has(s.says("hw:0", -EBUSY), "fuser"); // nobody is seen
    s.two_cards();
    s.process(812, "mpd", "/dev/snd/pcmC2D0p");
    s.process(900, "arecord", "/dev/snd/pcmC2D0c");
    s.process(901, "aplay", "/dev/snd/pcmC0D0p");
    const std::string text = s.says("hw:CARD=DAC8x", -EBUSY);
    has(text, "mpd (process 812)");
    has(text, "kill 812");
    CHECK(text.find("900") == std::string::npos);
    CHECK(text.find("901") == std::string::npos);
    // A name that hides its card: all that play.
    has(s.says("mine", -EBUSY), "mpd (process 812), aplay (process 901)");
}

TEST_CASE("a busy device names the program of another user, which only the driver knows")
{
    const fake_system s;
    s.two_cards();
    s.write("proc/asound/card2/pcm0p/sub0/status", "state: RUNNING\nowner_pid   : 4243\n");
    s.write("proc/asound/card0/pcm0p/sub0/status", "closed\n");
    s.write("proc/4243/status", "Name:\tdata-loop.0\nTgid:\t4240\n");
    s.write("proc/4240/comm", "pipewire\n");
    const std::string text = s.says("plughw:2,0", -EBUSY);
    has(text, "pipewire (process 4240)");
    has(text, "udev");
    CHECK(text.find("kill") == std::string::npos);
}

TEST_CASE("a missing sound server is named, with an alternative")
{
    const fake_system s;
    const std::string none = s.says("default", -EHOSTDOWN);
    has(none, "a sound server (PipeWire, PulseAudio) that is not running");
    has(none, "systemctl --user start pipewire-pulse");
    has(none, "device = hw:CARD=NAME");
    CHECK(none.find("Host is down") == std::string::npos);
    s.two_cards();
    for (const int code : {-EHOSTDOWN, -ECONNREFUSED})
        has(s.says("pulse", code), "tactor devices lists all");
    CHECK(s.says("default", -EHOSTDOWN).find("hw:CARD=NAME") == std::string::npos);
}

TEST_CASE("a missing plugin of ALSA's is named with its package")
{
    const fake_system s;
    const auto missing = [&](const std::string& type) {
        const std::string file = "libasound_module_pcm_" + type + ".so";
        const std::string text =
            s.leads({"plug", type}, -ENXIO,
                    "Cannot open shared library " + file + " (/usr/lib/alsa-lib/" + file +
                        ": cannot open shared object file: No such file or directory)");
        has(text, "PCM \"default\": a plugin of ALSA's is missing: Cannot open shared library " + file);
        CHECK(text.find("there is no sound card") == std::string::npos);
        return text;
    };
    for (const char* type : {"pulse", "jack", "oss", "usb_stream", "a52", "speex", "upmix", "vdownmix"})
        has(missing(type), "sudo apt install libasound2-plugins; or play on a card: device = hw:CARD=NAME");
    has(s.leads({}, -ENOENT, "Cannot open shared library libasound_module_conf_pulse.so (none)"),
        "sudo apt install libasound2-plugins");
    has(missing("pipewire"), "sudo apt install pipewire-alsa;");
    const std::string unknown = missing("pulze");
    has(unknown,
        "check the spelling of the type pulze in its definition, or install the package with that file");
    CHECK(unknown.find("apt") == std::string::npos);
    s.two_cards();
    has(missing("pulse"), "device = hw:CARD=Headphones");
    const std::string said = caught_message(
        [] { return open_alsa({.pcm = "t", .channels = 1, .config_text = "pcm.t { type nobodys }"}); });
    has(said, "a plugin of ALSA's is missing: ");
    has(said, "check the spelling of the type nobodys in its definition");
}

TEST_CASE("JACK without its server is named, whose plugin only says that there is nothing")
{
    const fake_system s;
    const std::string text = s.leads({"plug", "jack"}, -ENOENT);
    has(text, "it leads to JACK, but no JACK server is running");
    has(text, "jackd");
    has(text, "device = hw:CARD=NAME");
    CHECK(text.find("there is no sound card") == std::string::npos);
    for (const int code : {-ECONNREFUSED, -EHOSTDOWN})
        has(s.leads({"pipewire"}, code), "a sound server (PipeWire, PulseAudio) that is not running");
}

TEST_CASE("a missing card is reported only for PCMs that lead to one")
{
    const fake_system s;
    for (const std::vector<std::string>& route : {std::vector<std::string>{}, {"hw"}, {"plug", "dmix", "hw"}})
        has(s.leads(route, -ENOENT), "there is no sound card");
    const std::string text = s.leads({"plug"}, -ENOENT, "Unknown PCM palm");
    has(text, "refers to something that is not defined: Unknown PCM palm");
    CHECK(text.find("there is no sound card") == std::string::npos);
}

TEST_CASE("an unknown card lists the existing ones")
{
    const fake_system s;
    s.two_cards();
    for (const char* name : {"hw:CARD=DAC8", "hw:DAC8", "plughw:CARD=DAC8,DEV=0", "front:CARD=DAC8,DEV=0"}) {
        const std::string text = s.says(name, -ENODEV);
        has(text, "no card DAC8 ");
        has(text, "did you mean DAC8x?");
        has(text, "cards: Headphones, DAC8x");
    }
    has(s.says("hw:1", -ENOENT), "no card 1");
}

TEST_CASE("an unknown device of a card lists the ones that play")
{
    const fake_system s;
    s.two_cards();
    const std::string text = s.says("hw:CARD=DAC8x,DEV=1", -ENOENT);
    has(text, "card DAC8x has no playback device 1");
    has(text, "0, 3");
}

TEST_CASE("on a machine without cards the message says so, and that null needs none")
{
    const fake_system s;
    for (const char* name : {"hw:CARD=Tactor", "default", "hw:0,0"}) {
        const std::string text = s.says(name, -ENOENT);
        has(text, "there is no sound card");
        has(text, "null");
    }
    s.write("proc/asound/cards", "--- no soundcards ---\n");
    has(s.says("hw:0", -ENOENT), "there is no sound card");
}

TEST_CASE("an unknown PCM names a near one, or all when they are few")
{
    const fake_system s;
    s.two_cards();
    has(s.says("tactro", -ENOENT, {"default", "null", "tactor"}), "did you mean tactor?");
    has(s.says("xyz", -ENOENT, {"default", "null", "tactor"}), "known: default, null, tactor");
    has(s.says("xyz", -ENOENT), "cards: Headphones, DAC8x");
}

TEST_CASE("a PCM whose definition refers to a missing one is not reported as misspelt")
{
    const fake_system s;
    s.two_cards();
    const std::string text = s.says("soft", -ENOENT, {"default", "null", "soft"});
    has(text, "PCM \"soft\": its definition in ALSA's configuration refers to something that is not defined");
    CHECK(text.find("did you mean") == std::string::npos);
    const std::string said = caught_message([] {
        return open_alsa(
            {.pcm = "soft", .channels = 1, .config_text = "pcm.soft { type plug slave.pcm nobodys }"});
    });
    CHECK(said.find("did you mean") == std::string::npos);
    has(said, "nobodys");
}

TEST_CASE("a card's id or name alone proposes the card's PCM")
{
    const fake_system s;
    s.two_cards();
    for (const char* name : {"DAC8x", "dac8x", "DAC8", "snd_rpi_hifiberry_dac8x"})
        has(s.says(name, -ENOENT, {"default", "null"}), "no such PCM (did you mean hw:CARD=DAC8x? ");
    has(s.says("nul", -ENOENT, {"default", "null"}), "did you mean null? ");
}

TEST_CASE("a missing permission names the group to join, and how")
{
    const fake_system s;
    has(s.says("hw:0", -EACCES), "sudo usermod -aG audio $USER");
    s.write("dev/snd/pcmC0D0p", ""); // a node of the group that runs this test
    const std::string group = alsa::playback_group(s.root());
    if (group == "root")
        has(s.says("hw:0", -EPERM), "only root may open");
    else
        has(s.says("hw:0", -EPERM), "usermod -aG " + (group.empty() ? "audio" : group) + " $USER");
}

TEST_CASE("a lost PCM is retried after twice as long each time, up to 5 s, until the wait is given up")
{
    alsa_options o{.pcm = "gone", .channels = 1, .config_text = "pcm.other { type null }"};
    std::vector<double> waits;
    const auto s = reopen_alsa(o, [&](double t) {
        waits.push_back(t);
        return waits.size() < 10;
    });
    CHECK(s == nullptr);
    CHECK(waits == std::vector<double>{0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0, 5.0, 5.0});
}

TEST_CASE("a PCM that is back is opened after the first wait, and a wrong request does not wait")
{
    alsa_options o{.pcm = "back", .channels = 1, .config_text = "pcm.back { type null }"};
    int waits = 0;
    const auto pause = [&](double) { return ++waits < 10; };
    CHECK(reopen_alsa(o, pause) != nullptr);
    CHECK(waits == 1);
    o.channels = 0;
    CHECK_THROWS_AS(reopen_alsa(o, pause), error);
    CHECK(waits == 2);
}

TEST_CASE("the card and the device in an ALSA name")
{
    const auto is = [](const char* name, const std::string& card, unsigned device) {
        const auto d = alsa::parse_device_name(name);
        INFO(name);
        REQUIRE(d);
        CHECK(d->card == card);
        CHECK(d->device == device);
    };
    is("hw:CARD=Tactor", "Tactor", 0);
    is("hw:CARD=Tactor,DEV=2", "Tactor", 2);
    is("hw:Tactor,3", "Tactor", 3);
    is("plughw:1,2,0", "1", 2);
    is("surround71:CARD=PCH,DEV=0", "PCH", 0);
    for (const char* name : {"null", "default", "raw:/tmp/x", "", ":", "file:hw"})
        CHECK_FALSE(alsa::parse_device_name(name));
}

TEST_CASE("the host program keeps its handlers of libasound's messages")
{
    const auto fails = [] { CHECK_THROWS_AS(open_alsa({.pcm = "no-such-pcm", .channels = 1}), error); };
    const auto host = snd_lib_error;
    fails();
    const bool kept = snd_lib_error == host;
    CHECK(kept);

    static unsigned heard = 0;
    const auto own = [](const char*, int, const char*, int, const char*, va_list) { ++heard; };
    const snd_local_error_handler_t before = alsa::set_local_handler(own);
    fails();
    { // These messages are the error's detail, not the host's, and in between its own calls are its own.
        const auto sink = open_alsa({.pcm = "null", .channels = 1});
        CHECK(heard == 0);
        snd_pcm_t* p = nullptr;
        CHECK(snd_pcm_open(&p, "no-such-pcm", SND_PCM_STREAM_PLAYBACK, 0) < 0);
        CHECK(heard != 0);
    }
    const bool restored = alsa::set_local_handler(before) == static_cast<snd_local_error_handler_t>(own);
    CHECK(restored);
}

TEST_CASE("nested listeners hear the inner messages, and the outer one continues")
{
    const alsa::library_messages outer;
    {
        const alsa::library_messages inner;
        SNDERR("one");
        SNDERR("two");
        CHECK(inner.first() == "one");
    }
    CHECK(outer.first() == "");
    SNDERR("three \n");
    CHECK(outer.first() == "three");
}

} // namespace alsa_errors_test
