// SPDX-License-Identifier: MIT
// Devices, their names, and ALSA's configuration.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "caught.hpp"
#include "fake_dac.hpp"
#include "fake_system.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "sink/alsa/devices.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/plain_name.hpp"
#include "sink/alsa/route.hpp"

namespace devices_test {

using namespace tactor;
using types = std::vector<std::string>;

namespace {

pcm_info named(const std::vector<pcm_info>& all, const std::string& name)
{
    const auto same = [&](const pcm_info& p) { return p.name == name; };
    REQUIRE_MESSAGE(std::count_if(all.begin(), all.end(), same) == 1, name);
    return *std::find_if(all.begin(), all.end(), same);
}

// Definitions of a system and a user.
constexpr const char* definitions = R"(
pcm.hw { @args [ CARD DEV ] @args.CARD { type string default "0" } @args.DEV { type integer default 0 } type hw card $CARD device $DEV }
pcm.plug { @args [ SLAVE ] @args.SLAVE { type string } type plug slave.pcm $SLAVE }
pcm.null { type null }
pcm.file { @args [ FILE FORMAT ] @args.FILE { type string } @args.FORMAT { type string default raw } type file slave.pcm null file $FILE format $FORMAT }
pcm.palm { type route slave { pcm "hw:CARD=Tactor" channels 8 } ttable.0.0 1 }
pcm.pair { type multi slaves { a { pcm "hw:0" channels 2 } b "recorder" } bindings.0 { slave a channel 0 } }
pcm_slave.recorder { pcm "record" }
pcm.record { type file slave.pcm "hw:0" file "/tmp/x" format raw }
pcm.alias "record"
pcm.both { type asym playback.pcm "plug:'record'" capture.pcm "null" }
pcm.heard { type asym playback.pcm "null" capture.pcm "record" }
pcm.behind { type plug slave "recorder" }
pcm.round { type plug slave.pcm "round" }
pcm.wide { type multi slaves { a { pcm "wide" } b { pcm "wide" } c { pcm "wide" } d { pcm "wide" } } }
pcm.odd { type ladspa slave.pcm "hw:0" }
pcm.hinted { type null hint { type "file" } }
pcm.desk { type plug slave.pcm { type pipewire } }
)";

types route(const std::string& name)
{
    return alsa::find_route(alsa::read_configuration(definitions).get(), name);
}

std::string complaint(const std::string& name)
{
    return caught_message([&] { require_device_name(name); });
}

template <class Call>
std::string message(Call call)
{
    try {
        call();
    } catch (const error& e) {
        return e.what();
    }
    return {};
}

std::string refused(const std::string& texts)
{
    return message([&] {
        return open_alsa({.pcm = "t", .channels = 2, .config_text = "pcm.n { type null }\n" + texts});
    });
}

// The user's file of a home that has nothing else, while an object lives.
class users_file {
public:
    users_file() : file_(here_.path() / ".asoundrc")
    {
        if (const char* home = std::getenv("HOME"))
            before_ = home;
        ::setenv("HOME", here_.path().c_str(), 1);
    }
    ~users_file() { ::setenv("HOME", before_.c_str(), 1); }
    users_file(const users_file&) = delete;
    users_file& operator=(const users_file&) = delete;

    void write(const std::string& text) const { here_.write(".asoundrc", text); }
    std::string name() const { return file_.string(); }

private:
    folder here_;
    std::filesystem::path file_;
    std::string before_ = {};
};

} // namespace

TEST_CASE("all names that reach one place on a card keep one drive time, and the null device none")
{
    const alsa::card_place place{.card = "Tactor", .device = 1, .subdevice = 2};
    const stream_wiring straight;
    for (const auto& [name, route] : {std::pair<std::string, std::vector<std::string>>{"hw:0,1,2", {"hw"}},
                                      {"hw:CARD=Tactor,DEV=1", {"hw"}},
                                      {"plughw:Tactor,1", {"plug", "hw"}},
                                      {"default", {"plug", "dmix", "hw"}}})
        CHECK(alsa::find_drive_time_device(name, route, place, straight) == "hw:CARD=Tactor,DEV=1,SUBDEV=2");
    CHECK(alsa::find_drive_time_device("pulse", {"pulse"}, {}, straight) == "pulse");
    CHECK(alsa::find_drive_time_device("null", {"null"}, {}, straight).empty());
    CHECK(alsa::find_drive_time_device("file:x", {"file", "null"}, {}, straight).empty());
    CHECK(alsa::find_drive_time_device("half", {"route", "multi", "hw", "null"}, {}, straight) == "half");
    // A PCM of two cards has channels of its own.
    const stream_wiring two{.outputs = {{0}, {1024}}};
    CHECK(alsa::find_drive_time_device("both", {"multi", "hw", "hw"}, place, two) == "both");
}

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

TEST_CASE("a card names the built-in array that is made for it, by its USB id or its channel map")
{
    const test::fake_system s;
    s.write("proc/asound/cards", " 0 [Controller     ]: USB-Audio - DualSense Wireless Controller\n"
                                 " 1 [Wide           ]: USB-Audio - USB Sound Device\n"
                                 " 2 [Other          ]: USB-Audio - Other\n"
                                 " 3 [PCI            ]: HDA-Intel - HDA\n");
    s.write("proc/asound/pcm", "00-00: USB Audio : USB Audio : playback 1 : capture 1\n"
                               "01-00: USB Audio : USB Audio : playback 1\n"
                               "01-01: USB Audio #1 : USB Audio #1 : playback 1\n"
                               "02-00: USB Audio : USB Audio : playback 1 : capture 1\n"
                               "03-00: ALC : ALC : playback 1\n");
    s.write("proc/asound/card0/usbid", "054c:0ce6\n");
    s.write("proc/asound/card0/stream0", "Playback:\n  Channel map: FL FR RL RR\n");
    s.write("proc/asound/card1/usbid", "0d8c:0102\n");
    s.write("proc/asound/card1/stream0", "USB Sound Device at usb-1, full speed : USB Audio\n\nPlayback:\n"
                                         "  Status: Stop\n  Interface 1\n    Altset 1\n    Channels: 2\n"
                                         "    Channel map: FL FR\n  Interface 1\n    Altset 2\n"
                                         "    Channels: 8\n    Channel map: FL FR FC LFE RL RR SL SR\n");
    s.write("proc/asound/card1/stream1", "Playback:\n    Channel map: FL FR FC LFE SL SR RL RR\n");
    s.write("proc/asound/card2/usbid", "054c:0ce7\n");
    s.write("proc/asound/card2/stream0", "Playback:\n    Channel map: FL FR\n\nCapture:\n"
                                         "    Channel map: FL FR FC LFE RL RR SL SR\n");
    const auto all = alsa::list(s.root(), {});
    for (const auto& [name, preset] : {std::pair("hw:CARD=Controller,DEV=0", "dualsense"),
                                       {"hw:CARD=Wide,DEV=0", "usb-7.1"},
                                       {"hw:CARD=Wide,DEV=1", ""},
                                       {"hw:CARD=Other,DEV=0", ""},
                                       {"hw:CARD=PCI,DEV=0", ""},
                                       {"null", ""}}) {
        CAPTURE(name);
        CHECK(named(all, name).preset == preset);
    }
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

TEST_CASE("a PCM's properties are found without configuring it")
{
    test::fake_dac dac({.least_channels = 2, .most_channels = 64});
    pcm_info p;
    alsa::inspect_pcm(dac.pcm(), alsa_options{.channels = 9}, p);
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
        alsa::inspect_pcm(dac.pcm(), o, other);
        CHECK(other.opened);
        CHECK(other.misfit.find("unsupported ") != std::string::npos);
    }
    snd_pcm_close(dac.pcm());
}

TEST_CASE("channel counts with gaps stay apart")
{
    test::fake_dac dac({.channel_counts = {2, 3, 8}});
    pcm_info p;
    alsa::inspect_pcm(dac.pcm(), alsa_options{.channels = 5}, p);
    REQUIRE(p.can->channels.size() == 2);
    CHECK(p.can->channels[0].least == 2);
    CHECK(p.can->channels[0].most == 3);
    CHECK(p.can->channels[1].least == 8);
    CHECK(p.can->channels[1].most == 8);
    CHECK(p.misfit.find("unsupported number of channels") != std::string::npos);
    snd_pcm_close(dac.pcm());
}

TEST_CASE("names of devices are plain")
{
    for (const char* name :
         {"null", "default", "palm-3x3", "hw:0", "hw:1,3", "hw:CARD=Tactor", "hw:CARD=Tactor,DEV=0,SUBDEV=1",
          "plughw:CARD=DAC8x,DEV=0", "plug:null", "plug:palm", "plug:hw:0", "plug:hw:CARD=Tactor",
          "plug:SLAVE=hw:0", "plug:'hw:1,3'", "plug:SLAVE='hw:CARD=Tactor,DEV=0'", "sysdefault:CARD=2",
          "surround71:CARD=A_b-C", "pulse:alsa_output.usb-Acme_DAC-00.pro-output-0"}) {
        CAPTURE(name);
        CHECK(alsa::find_plain_name_fault(name) == "");
    }
}

TEST_CASE("names with more than a device are not plain, and have a reason")
{
    const auto why = [](std::string_view name) { return alsa::find_plain_name_fault(name); };
    for (const char* name : {"file:'|id > X; cat >/dev/null',raw",
                             "a b",
                             "{ type file }",
                             "hw:{ CARD 0 }",
                             "hw:$HOME",
                             "hw:@x",
                             "a.b",
                             "hw:\\x41",
                             "hw:0\nfile:x",
                             "hw:\"0\"",
                             "plug:'file:\"x\"'",
                             "plug:file:'x'",
                             "plug:'plug:hw:0'",
                             "plug:'hw:0',x",
                             "plug:hw:0,1",
                             "plug:SLAVE=SLAVE=hw:0",
                             "plug:",
                             "plug:'",
                             "hw:",
                             "hw:CARD=",
                             ":0",
                             "",
                             "hw:CARD=a=b",
                             "hw:../../x",
                             "hw:0,",
                             "\xc3\xa9",
                             "hw:\x7f"}) {
        CAPTURE(name);
        CHECK(why(name) != "");
    }
    CHECK(why(std::string_view("hw:0\0x", 6)) == "it must not contain the byte 0x00");
    CHECK(why("file:'|id'") == "it must not contain '");
    CHECK(why("hw:0\n") == "it must not contain the byte 0x0a");
    has(why("plug:hw:0,1"), "single quotes");
    CHECK(why(std::string(200, 'a')) == "");
    has(why(std::string(201, 'a')), "200 bytes");
}

TEST_CASE("the route of a name is ALSA's, in any spelling")
{
    CHECK(route("hw:CARD=Tactor,DEV=1") == types{"hw"});
    CHECK(route("plug:'hw:0,1'") == types{"plug", "hw"});
    CHECK(route("palm") == types{"route", "hw"});
    CHECK(route("nowhere").empty());
    CHECK(route("plug:nowhere") == types{"plug"});
    for (const char* name :
         {"record", "alias", "both", "behind", "pair", "plug:record", "file:x", "file:FILE=x,FORMAT=wav"}) {
        CAPTURE(name);
        CHECK(alsa::writes(route(name)));
        CHECK(alsa::unsafe_type(route(name)) == "file");
        CHECK(alsa::lasting_type(route(name)) == "file");
    }
    // Definitions for recording only do nothing.
    CHECK(route("heard") == types{"asym", "null"});
    CHECK(route("hinted") == types{"null"});
    CHECK(alsa::find_route(nullptr, "hw:0").empty());
}

TEST_CASE("a definition that leads to itself, or doubles at each step, ends and is not safe")
{
    for (const char* name : {"round", "wide"}) {
        CAPTURE(name);
        CHECK(alsa::unsafe_type(route(name)) == "?");
        CHECK(route(name).size() < 200);
    }
}

TEST_CASE("an unknown type is not safe, and sound servers are named")
{
    CHECK(alsa::unsafe_type(route("odd")) == "ladspa");
    CHECK(alsa::unsafe_type(route("desk")) == "");
    CHECK(alsa::find_server(route("desk")) == "PipeWire");
    CHECK(alsa::lasting_type(route("desk")) == "pipewire");
    CHECK(alsa::find_server(route("palm")) == "");
    CHECK(alsa::find_server({"plug", "jack"}) == "JACK");
    CHECK(alsa::find_server({"pulse"}) == "PulseAudio");
}

TEST_CASE("an unsafe name chosen by others is refused with the reason, before it is opened")
{
    CHECK(complaint("null") == "");
    CHECK(complaint("plug:null") == "");
    CHECK(complaint("hw:CARD=Nowhere") == "");
    CHECK(complaint("nobody-defines-this") == "");
    has(complaint("file:'|id > X',raw"), "PCM 'file:'|id > X',raw': it must not contain '");
    // It looks harmless, but ALSA defines it as a file.
    has(complaint("file:victim,raw"), "it writes a file or starts a command");
    has(complaint("tee:hw"), "it writes");
    CHECK(read_route("file:x").writes);
    CHECK_FALSE(read_route("plug:null").writes);
    CHECK(read_route("plug:null").server == "");
}

TEST_CASE("a definition on which libasound would end the process is refused, with the reason")
{
    const auto says = [](const std::string& definitions, const std::string& why) {
        has(refused(definitions), "PCM \"t\": " + why);
    };
    const std::string four = "slaves.a { pcm n channels 4 } ";
    const std::string hole = "pcm.t { type multi " + four +
                             "bindings { 0 { slave a channel 0 } 1 { slave a "
                             "channel 1 } 3 { slave a channel 3 } } }";
    says(hole, "type multi leaves a gap in its bindings: it has no channel 2");
    says("pcm.t { type plug slave.pcm { type multi " + four + "bindings.1 { slave a channel 0 } } }",
         "type multi leaves a gap in its bindings: it has no channel 0");
    says("pcm.t { type multi " + four + "bindings { 4294967296 { slave a channel 0 } } }",
         "type multi has a channel beyond the largest possible, 1024");
    says("pcm.t { type share slave { pcm n channels 2 } bindings { 0 0 1 2 } }",
         "type share has a channel beyond the largest possible, 2");
    says("pcm_slave.two { pcm n channels 2 }\npcm.t { type share slave two bindings { 0 -1 } }",
         "type share has a channel beyond the largest possible, 2");
    for (const char* type : {"route", "plug"})
        says(fmt::format("pcm.t {{ type {} slave.pcm n ttable.65535.65535 1 }}", type),
             fmt::format("type {} has a channel beyond the largest possible, 1024", type));
    says("pcm.t { type plug slave.pcm { type plug slave.pcm t } }", "its definition refers to itself");
    CHECK(refused("pcm.t { type multi " + four +
                  "bindings { 1 { slave a channel 0 } 0 { slave a channel 3 } } }") == "");
}

TEST_CASE("a chain of twenty plugins, and a PCM of a hundred cards, are not refused")
{
    std::string chain = "n";
    std::string slaves;
    std::string bindings;
    for (unsigned i = 0; i < 100; ++i) {
        slaves += fmt::format(" s{} {{ pcm n channels 1 }}", i);
        bindings += fmt::format(" {} {{ slave s{} channel 0 }}", i, i);
    }
    for (unsigned i = 0; i < 20; ++i)
        chain = fmt::format("{{ type copy slave.pcm {} }}", chain);
    CHECK(refused("pcm.t " + chain) == "");
    const std::string cards = fmt::format(
        "pcm.n {{ type null }}\npcm.t {{ type multi slaves {{{} }} bindings {{{} }} }}", slaves, bindings);
    CHECK(open_alsa({.pcm = "t", .channels = 100, .config_text = cards})->setup().channels == 100);
}

TEST_CASE("each try reads the configuration again, and leaves libasound's own copy alone")
{
    const users_file file;
    const alsa_options o{.pcm = "later", .channels = 2};
    snd_config_update();
    snd_config_t* const hosts = snd_config;
    has(message([&] { return open_alsa(o); }), "no such PCM");
    CHECK(read_route("later").types.empty());
    file.write("pcm.later { type copy slave.pcm \"null\" }\n");
    CHECK(open_alsa(o)->setup().channels == 2);
    CHECK(read_route("later").types.size() == 2);
    CHECK(snd_config == hosts);
}

TEST_CASE("a configuration that ALSA cannot read is reported with its file and line, also by the list")
{
    const users_file file;
    file.write("pcm.output {\n  type hw\n  card \n}\n");
    const std::string said = message([] { return open_alsa({.channels = 1}); });
    CHECK(said == file.name() + ":5: ALSA cannot read its configuration: Unexpected char (repair or remove "
                                "this file, or one that it includes; ALSA plays nothing until then)");
    const auto pcms = list_pcms(alsa_options{.channels = 1});
    REQUIRE_FALSE(pcms.empty());
    CHECK(pcms.back().error == said);
    CHECK(read_route("null").types.empty());
}

TEST_CASE("a name with a colon after which ALSA cannot read is bad input")
{
    const auto says = [](const std::string& name, const std::string& why) {
        CHECK(
            caught_message([&] { return open_alsa({.pcm = name, .channels = 1}); })
                .starts_with(fmt::format("PCM \"{}\": ALSA cannot read the part after the colon: {} (write a "
                                         "device as hw:CARD=NAME",
                                         name, why)));
    };
    says("hw:CARD=Tactor,", "a part of it is empty");
    says("hw:CARD=", "a part of it is empty");
    says("hw:0,x", "Parameter DEV must be an integer");
    says("hw:X=1", "Unknown parameter X");
    says("hw:0,0,0,0", "Unknown parameter 3");
}

} // namespace devices_test
