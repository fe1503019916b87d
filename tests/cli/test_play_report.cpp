// SPDX-License-Identifier: MIT
// The final message of a run whose strokes did not all finish.
#include "cli/play/play.hpp"

#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace play_report_test {

using namespace tactor;
using namespace tactor::cli;

namespace {

constexpr const char* tired = "it is tired";

stroke_outcome ended(const char* name, state_kind how)
{
    stroke_report r{.state = how, .frames = 24000};
    if (how != state_kind::finished)
        r.why = tired;
    return {name, 48000, r};
}

play_report run(std::vector<stroke_outcome> strokes)
{
    play_report r;
    r.device.rate = 48000;
    r.strokes = std::move(strokes);
    return r;
}

std::string said(std::vector<stroke_outcome> strokes)
{
    const auto e = unfinished(run(std::move(strokes)));
    REQUIRE(e);
    CHECK(e->kind() == error_kind::runtime);
    return e->what();
}

} // namespace

TEST_CASE("a run whose strokes all finished has no message")
{
    CHECK_FALSE(unfinished(run({ended("a", state_kind::finished), ended("b", state_kind::finished)})));
}

TEST_CASE("one stroke that did not finish is an error, wherever it is")
{
    const stroke_outcome whole = ended("a", state_kind::finished);
    const stroke_outcome cut = ended("b", state_kind::interrupted);
    CHECK(said({cut}) == "b: interrupted after 0.500 s: it is tired");
    CHECK(said({cut, whole}) == said({cut}));
    CHECK(said({whole, cut}) == said({cut}));
    CHECK(said({ended("b", state_kind::cancelled), whole}) == "b: cancelled after 0.500 s: it is tired");
}

TEST_CASE("of several unfinished strokes the last is named, with their number")
{
    CHECK(said({ended("a", state_kind::interrupted), ended("b", state_kind::finished),
                ended("c", state_kind::interrupted)}) ==
          "c: interrupted after 0.500 s: it is tired; 2 of 3 strokes did not finish");
    CHECK(said({ended("a", state_kind::interrupted), {"b"}}) ==
          "b: not played; 2 of 2 strokes did not finish");
}

} // namespace play_report_test
