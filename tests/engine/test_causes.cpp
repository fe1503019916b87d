// SPDX-License-Identifier: MIT
// First causes, nested in the error that a caller gets.
#include <doctest/doctest.h>

#include <cerrno>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace causes_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Returns the errno of the error nested in what a call throws; 0 for none.
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

// Returns the text of the tactor::error nested in what a call throws; "" for none.
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

// Returns this result for each write.
class broken_sink final : public forwarding_sink {
public:
    broken_sink(std::unique_ptr<sink> s, io_result said) : forwarding_sink(std::move(s)), said_(said) {}
    io_result write(std::span<const std::byte>) noexcept override { return said_; }

private:
    io_result said_;
};

int cause_of_start(io_result said)
{
    fake_dac dac;
    return system_cause(
        [&] { const player p(std::make_unique<broken_sink>(alsa::adopt(dac.pcm(), nine()), said), palm()); });
}

} // namespace

TEST_CASE("a refusal of the system is nested with its errno")
{
    const folder here;
    CHECK(system_cause([&] { static_cast<void>(load_setup(here / "none.toml")); }) == ENOENT);
    CHECK(system_cause([&] { static_cast<void>(load_strokes(here / "none.csv")); }) == ENOENT);
    CHECK(system_cause([&] { write_wav(tone(0.001), format_kind::s16, "/dev/full"); }) == ENOSPC);
    CHECK(system_cause([] { static_cast<void>(open_alsa({.pcm = "no-such-pcm", .channels = 2})); }) ==
          ENOENT);
}

TEST_CASE("a stream that does not start has the errno of its device")
{
    CHECK(cause_of_start({io_kind::failed, 0, -EIO}) == EIO);
    CHECK(cause_of_start({io_kind::lost, 0, -ENODEV}) == ENODEV);
    CHECK(cause_of_start({io_kind::failed, 0, 0}) == 0);
}

TEST_CASE("the error of a file within a file is nested in that of the outer")
{
    const folder here;
    const auto outer = here.write("outer.toml", "[array]\nfile = \"none.toml\"\n");
    const std::string cause = own_cause([&] { static_cast<void>(load_setup(outer)); });
    has(cause, "none.toml: No such file or directory");
    CHECK(os_code([&] { static_cast<void>(load_setup(outer)); }) == ENOENT);
    const auto sound = here.write("s.toml", "[stroke]\npoints = [[0, 0], [9, 0]]\nduration_s = 1\n"
                                            "waveform = \"./none.wav\"\n");
    CHECK(os_code([&] { static_cast<void>(load_strokes(sound)); }) == ENOENT);
    const std::string geometry = own_cause(
        [] { static_cast<void>(parse_strokes_toml("[stroke]\npath = \"M 0 0 X\"\nduration_s = 1\n", "s")); });
    CHECK(!geometry.empty());
}

TEST_CASE("an error without a cause nests nothing")
{
    CHECK(own_cause([] { static_cast<void>(preset_stroke("no-such")); }).empty());
    CHECK(system_cause([] { static_cast<void>(preset_stroke("no-such")); }) == 0);
}

} // namespace causes_test
