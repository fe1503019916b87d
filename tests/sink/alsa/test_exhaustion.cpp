// SPDX-License-Identifier: MIT
// ALSA's configuration without descriptors: unread parts do not count as read.
#include <cerrno>
#include <cstdlib>
#include <string>
#include <vector>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "descriptors_left.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "sink/alsa/library_messages.hpp"

namespace alsa_exhaustion_test {

using namespace tactor;

namespace {

// A configuration like the system's, not read yet: a file that loads the user's, if it can, which includes
// another.
class own_configuration {
public:
    own_configuration()
    {
        const auto included = here_.write("included.conf", "pcm.mine { type plug slave.pcm null }\n");
        const auto users = here_.write("asoundrc", "<" + included.string() + ">\n");
        const auto top = here_.write("alsa.conf", "@hooks [ { func load files [ \"" + users.string() +
                                                      "\" ] errors false } ]\npcm.null { type null }\n");
        if (const char* p = std::getenv(variable))
            before_ = p;
        ::setenv(variable, top.c_str(), 1);
        snd_config_update_free_global();
    }
    ~own_configuration()
    {
        if (before_.empty())
            ::unsetenv(variable);
        else
            ::setenv(variable, before_.c_str(), 1);
        snd_config_update_free_global();
    }
    own_configuration(const own_configuration&) = delete;
    own_configuration& operator=(const own_configuration&) = delete;

private:
    static constexpr const char* variable = "ALSA_CONFIG_PATH";

    folder here_;
    std::string before_;
};

alsa_options of(const char* pcm)
{
    return {.pcm = pcm, .channels = 9};
}

// Returns false where a call failed for want of descriptors.
template <typename Call>
bool answers(Call call)
{
    try {
        call();
        return true;
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::runtime);
        has(e.what(), "Too many open files");
        has(e.what(), "ulimit -n");
        CHECK(e.os_code() == EMFILE);
        return false;
    }
}

bool opens_with(unsigned descriptors, const char* pcm)
{
    const test::descriptors_left few(descriptors);
    return answers([pcm] { static_cast<void>(open_alsa(of(pcm))); });
}

} // namespace

TEST_CASE("a PCM that could not be opened for want of descriptors opens when there are some")
{
    for (const char* pcm : {"null", "mine"}) {
        CAPTURE(pcm);
        bool opened = false;
        for (unsigned n = 0; !opened; ++n) {
            CAPTURE(n);
            REQUIRE(n < 20);
            const own_configuration fresh;
            opened = opens_with(n, pcm);
            CHECK(open_alsa(of("mine"))->setup().channels == 9);
        }
    }
}

TEST_CASE("waiting for a lost PCM reports a want of descriptors")
{
    const test::descriptors_left none(0);
    CHECK_THROWS_WITH_AS(
        static_cast<void>(reopen_alsa(of("null"), [n = 0](double) mutable { return ++n < 3; })),
        doctest::Contains("Too many open files"), error);
}

TEST_CASE("queries of names without descriptors say so, and leave nothing broken behind")
{
    for (unsigned n = 0; n < 10; ++n) {
        CAPTURE(n);
        const own_configuration fresh;
        {
            const test::descriptors_left few(n);
            // Its files are open at the same time: one and the one that it names.
            CHECK(answers([] { CHECK(read_route("mine").types.size() == 2); }) == (n >= 2));
            CHECK(answers([] { static_cast<void>(read_wiring("mine", 9)); }) == (n >= 2));
            CHECK(answers([] { require_device_name("mine"); }) == (n >= 2));
            CHECK(answers([] { static_cast<void>(list_pcms()); }) == (n >= 2));
        }
        CHECK(read_route("mine").types == std::vector<std::string>{"plug", "null"});
        CHECK(open_alsa(of("mine"))->setup().channels == 9);
    }
}

TEST_CASE("a configuration that another part of the program could not read is read anew")
{
    const own_configuration fresh;
    {
        const test::descriptors_left none(0);
        const alsa::library_messages silent;
        snd_config_update();
    }
    CHECK(open_alsa(of("mine"))->setup().channels == 9);
}

} // namespace alsa_exhaustion_test
