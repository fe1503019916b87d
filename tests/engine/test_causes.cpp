// SPDX-License-Identifier: MIT
// What went wrong first is nested in the error that a caller gets.
#include <doctest/doctest.h>

#include <cerrno>
#include <exception>
#include <functional>
#include <string>
#include <system_error>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/gpio.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>
#include <tactor/wav.hpp>

#include "folder.hpp"
#include "has.hpp"
#include "scores.hpp"

namespace causes_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// The errno of what is nested in what a call throws; 0 where nothing is.
int system_cause(const std::function<void()>& call)
{
    try {
        call();
    } catch (const error& e) {
        try {
            std::rethrow_if_nested(e);
        } catch (const error&) {
            FAIL("an error of our own");
        } catch (const std::system_error& cause) {
            CHECK(cause.code().category() == std::generic_category());
            CHECK(e.os_code() == cause.code().value());
            return cause.code().value();
        }
    }
    return 0;
}

// The text of the nested error of ours; "" where nothing is nested.
std::string own_cause(const std::function<void()>& call)
{
    try {
        call();
    } catch (const error& e) {
        try {
            std::rethrow_if_nested(e);
        } catch (const error& cause) {
            return cause.what();
        }
    }
    return "";
}

} // namespace

TEST_CASE("what the system refused is nested with its errno")
{
    const folder here;
    CHECK(system_cause([&] { static_cast<void>(load_setup(here / "none.toml")); }) == ENOENT);
    CHECK(system_cause([&] { static_cast<void>(load_strokes(here / "none.csv")); }) == ENOENT);
    CHECK(system_cause([&] { write_wav(tone(0.001), format_kind::s16, "/dev/full"); }) == ENOSPC);
    CHECK(system_cause([] { static_cast<void>(open_alsa({.pcm = "no-such-pcm", .channels = 2})); }) ==
          ENOENT);
}

TEST_CASE("an error of a file within a file is nested in that of the outer")
{
    const folder here;
    const auto outer = here.write("outer.toml", "[array]\nfile = \"none.toml\"\n");
    const std::string cause = own_cause([&] { static_cast<void>(load_setup(outer)); });
    has(cause, "none.toml: No such file or directory");
    const std::string geometry = own_cause([] {
        static_cast<void>(parse_strokes_toml("[stroke]\npoints = [[0, 0], [0, 0]]\nduration_s = 1\n", "s"));
    });
    CHECK(!geometry.empty());
}

TEST_CASE("an error without a cause has none")
{
    CHECK(own_cause([] { static_cast<void>(preset_stroke("no-such")); }).empty());
    CHECK(system_cause([] { static_cast<void>(preset_stroke("no-such")); }) == 0);
}

} // namespace causes_test
