// SPDX-License-Identifier: MIT
// Names of PCMs chosen by others: recognising names of devices, and following the rest.
#include <string>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "has.hpp"
#include "sink/alsa/devices/plain_name.hpp"
#include "sink/alsa/devices/route.hpp"

namespace pcm_names_test {

using namespace tactor;
using types = std::vector<std::string>;

namespace {

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

struct configuration {
    snd_config_t* top = nullptr;
    configuration() { REQUIRE(snd_config_load_string(&top, definitions, 0) == 0); }
    ~configuration() { snd_config_delete(top); }
    configuration(const configuration&) = delete;
    configuration& operator=(const configuration&) = delete;
    types operator()(const std::string& name) const { return alsa::find_route(top, name); }
};

std::string complaint(const std::string& name)
{
    try {
        require_device_name(name);
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
    return {};
}

} // namespace

TEST_CASE("names of devices are plain")
{
    for (const char* name :
         {"null", "default", "palm-3x3", "hw:0", "hw:1,3", "hw:CARD=Tactor", "hw:CARD=Tactor,DEV=0,SUBDEV=1",
          "plughw:CARD=DAC8x,DEV=0", "plug:null", "plug:palm", "plug:hw:0", "plug:hw:CARD=Tactor",
          "plug:SLAVE=hw:0", "plug:'hw:1,3'", "plug:SLAVE='hw:CARD=Tactor,DEV=0'", "sysdefault:CARD=2",
          "surround71:CARD=A_b-C", "pulse:alsa_output.usb-Acme_DAC-00.pro-output-0"}) {
        CAPTURE(name);
        CHECK(alsa::not_plain(name) == "");
    }
}

TEST_CASE("names with more than a device are not plain, and have a reason")
{
    const auto why = [](std::string_view name) { return alsa::not_plain(name); };
    for (const char* name : {"file:'|id > X; cat >/dev/null',raw",
                             "file:FILE=/home/me/x",
                             "tee:hw:0,'|sh'",
                             "file:|id",
                             "file:a b",
                             "a b",
                             "{ type file }",
                             "plug:{ type file slave.pcm null file x }",
                             "hw:{ CARD 0 }",
                             "hw:$HOME",
                             "hw:@x",
                             "@x",
                             "a.b",
                             "hw:\\x41",
                             "hw:0\nfile:x",
                             "hw:0;",
                             "hw:\"0\"",
                             "plug:'file:\"x\"'",
                             "plug:file:'x'",
                             "plug:'plug:hw:0'",
                             "plug:plug:null",
                             "plug:SLAVE='hw:0",
                             "plug:'hw:0',x",
                             "plug:hw:0,1",
                             "plug:\"hw:0\"",
                             "plug:''hw:0''",
                             "plug:SLAVE=SLAVE=hw:0",
                             "plug:",
                             "plug:''",
                             "plug:'",
                             "hw:",
                             "hw:,",
                             "hw:CARD=",
                             "hw:=0",
                             ":0",
                             "",
                             "hw:CARD=a=b",
                             "hw:../../x",
                             "hw:/dev/snd/x",
                             "hw:0,",
                             "\xc3\xa9",
                             "hw:\x7f"}) {
        CAPTURE(name);
        CHECK(why(name) != "");
    }
    CHECK(why(std::string_view("hw:0\0x", 6)) == "the byte 0x00 may not stand in it");
    CHECK(why("file:'|id'") == "' may not stand in it");
    CHECK(why("hw:0\n") == "the byte 0x0a may not stand in it");
    has(why("plug:hw:0,1"), "single quotes");
    CHECK(why(std::string(200, 'a')) == "");
    has(why(std::string(201, 'a')), "200 bytes");
}

TEST_CASE("the route of a name is ALSA's, in any spelling")
{
    const configuration route;
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
    const configuration route;
    for (const char* name : {"round", "wide"}) {
        CAPTURE(name);
        CHECK(alsa::unsafe_type(route(name)) == "?");
        CHECK(route(name).size() < 200);
    }
}

TEST_CASE("an unknown type is not safe, and sound servers are named")
{
    const configuration route;
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
    has(complaint("file:'|id > X',raw"),
        "PCM 'file:'|id > X',raw': more than the name of a device: ' may not");
    // It looks harmless, but ALSA defines it as a file.
    has(complaint("file:victim,raw"), "it writes a file or starts a command");
    has(complaint("tee:hw"), "it writes");
    CHECK(read_route("file:x").writes);
    CHECK_FALSE(read_route("plug:null").writes);
    CHECK(read_route("plug:null").server == "");
}

} // namespace pcm_names_test
