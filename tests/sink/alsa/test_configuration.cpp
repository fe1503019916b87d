// SPDX-License-Identifier: MIT
// ALSA's configuration: definitions on which libasound would end the process, and files as they are now.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <random>
#include <string>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "folder.hpp"
#include "has.hpp"
#include "sink/alsa/configuration.hpp"
#include "sink/alsa/devices/route.hpp"

namespace alsa_configuration_test {

using namespace tactor;

namespace {

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

std::string refused(const std::string& definitions)
{
    return message([&] {
        static_cast<void>(
            open_alsa({.pcm = "t", .channels = 2, .config_text = "pcm.n { type null }\n" + definitions}));
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

// Random definitions of plugins with tables, most of which make sense.
class chance {
public:
    explicit chance(unsigned seed) : random_(seed) {}

    std::string text()
    {
        return fmt::format("pcm.n {{ type null }}\npcm.a {}\npcm.t {}\n", plugin(1), plugin(2));
    }

private:
    std::uint64_t below(std::uint64_t n) { return random_() % n; }

    std::string number(unsigned usual)
    {
        constexpr const char* odd[] = {"0", "1", "7", "1023", "65535", "4294967296"};
        return below(12) == 0 ? odd[below(std::size(odd))] : fmt::format("{}", usual);
    }

    std::string pcm(int depth)
    {
        if (depth > 0)
            return plugin(depth - 1);
        constexpr const char* names[] = {"n", "n", "n", "n", "a", "t"};
        return fmt::format("\"{}\"", names[below(std::size(names))]);
    }

    std::string plugin(int depth)
    {
        const auto n = static_cast<unsigned>(1 + below(4));
        std::string table;
        switch (below(4)) {
        case 0:
            for (unsigned i = 0; i < n; ++i)
                table += fmt::format(" {} {{ slave a channel {} }}", number(i), number(i));
            return fmt::format("{{ type multi slaves.a {{ pcm {} channels 4 }} bindings {{{} }} }}",
                               pcm(depth), table);
        case 1:
            for (unsigned i = 0; i < n; ++i)
                table += fmt::format(" {} {}", number(i), number(i));
            return fmt::format("{{ type share slave {{ pcm n channels {} }} bindings {{{} }} }}", number(4),
                               table);
        case 2:
            for (unsigned i = 0; i < n; ++i)
                table += fmt::format(" {}.{} 1", number(i), number(i));
            return fmt::format("{{ type {} slave.pcm {} ttable {{{} }} }}", below(2) == 0 ? "route" : "plug",
                               pcm(depth), table);
        default:
            return fmt::format("{{ type copy slave.pcm {} }}", pcm(depth));
        }
    }

    std::mt19937 random_;
};

} // namespace

TEST_CASE("a definition on which libasound would end the process is refused, with the reason")
{
    const auto says = [](const std::string& definitions, const std::string& why) {
        has(refused(definitions), "PCM \"t\": " + why);
    };
    const std::string four = "slaves.a { pcm n channels 4 } ";
    const std::string hole = "pcm.t { type multi " + four +
                             "bindings { 0 { slave a channel 0 } 1 { slave a "
                             "channel 1 } 3 { slave a channel 3 } } }";
    says(hole, "type multi leaves a hole in its bindings: it binds no channel 2");
    says("pcm.t { type plug slave.pcm { type multi " + four + "bindings.1 { slave a channel 0 } } }",
         "type multi leaves a hole in its bindings: it binds no channel 0");
    says("pcm.t { type multi " + four + "bindings { 4294967296 { slave a channel 0 } } }",
         "type multi has a channel beyond the 1024 that there can be");
    says("pcm.t { type share slave { pcm n channels 2 } bindings { 0 0 1 2 } }",
         "type share has a channel beyond the 2 that there can be");
    says("pcm_slave.two { pcm n channels 2 }\npcm.t { type share slave two bindings { 0 -1 } }",
         "type share has a channel beyond the 2 that there can be");
    for (const char* type : {"route", "plug"})
        says(fmt::format("pcm.t {{ type {} slave.pcm n ttable.65535.65535 1 }}", type),
             fmt::format("type {} has a channel beyond the 1024 that there can be", type));
    says("pcm.t { type plug slave.pcm { type plug slave.pcm t } }", "its definition leads to itself");
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

TEST_CASE("libasound opens or refuses all random definitions in which no fault is found")
{
    unsigned faults = 0;
    unsigned opened = 0;
    for (unsigned seed = 0; seed < 1000; ++seed) {
        const std::string text = chance(seed).text();
        INFO(text);
        const alsa::configuration top = alsa::read_configuration(text);
        faults += alsa::find_fault(top.get(), "t").empty() ? 0 : 1;
        try {
            opened += open_alsa({.pcm = "t", .channels = 1, .wider = true, .config_text = text}) != nullptr;
        } catch (const error& e) {
            CHECK(e.kind() == error_kind::not_available);
        }
    }
    CHECK(faults > 100);
    CHECK(opened > 100);
}

TEST_CASE("each try reads the configuration again, and leaves libasound's own copy alone")
{
    const users_file file;
    const alsa_options o{.pcm = "later", .channels = 2};
    snd_config_update();
    snd_config_t* const hosts = snd_config;
    has(message([&] { static_cast<void>(open_alsa(o)); }), "no such PCM");
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
    const std::string said = message([] { static_cast<void>(open_alsa({.channels = 1})); });
    CHECK(said == file.name() +
                      ":5: ALSA cannot read its configuration: Unexpected char (mend or remove this file, "
                      "or one that it includes; ALSA plays nothing until then)");
    const auto pcms = list_pcms(alsa_options{.channels = 1});
    REQUIRE_FALSE(pcms.empty());
    CHECK(pcms.back().error == said);
    CHECK(read_route("null").types.empty());
}

TEST_CASE("a name with a colon after which ALSA cannot read is bad input")
{
    const auto says = [](const std::string& name, const std::string& why) {
        try {
            static_cast<void>(open_alsa({.pcm = name, .channels = 1}));
            FAIL("it opened");
        } catch (const error& e) {
            CHECK(e.kind() == error_kind::bad_input);
            has(e.what(),
                fmt::format("PCM \"{}\": ALSA cannot read the part after the colon: {} (write a device as "
                            "hw:CARD=NAME",
                            name, why));
        }
    };
    says("hw:CARD=Tactor,", "a part of it is empty");
    says("hw:CARD=", "a part of it is empty");
    says("hw:0,x", "Parameter DEV must be an integer");
    says("hw:X=1", "Unknown parameter X");
    says("hw:0,0,0,0", "Unknown parameter 3");
}

} // namespace alsa_configuration_test
