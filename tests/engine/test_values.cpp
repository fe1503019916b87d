// SPDX-License-Identifier: MIT
// Values: names of enumerations, moved-from objects, and first causes of errors.
#include <cerrno>
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>
#include <tactor/tactor.hpp>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace values_test {

using namespace tactor;
using namespace tactor::test;

namespace {

path line()
{
    const std::vector<point> points{{0.0, 0.0}, {40.0, 30.0}};
    return path::polyline(points);
}

// Moves, checks the rest, assigns it anew.
template <typename T, typename Same>
void stays_usable(T a, T other, Same same)
{
    T b(std::move(a));
    CHECK(same(a));
    CHECK(same(b));
    a = other;
    CHECK(same(a));
    T c(b);
    c = std::move(b);
    CHECK(same(b));
    CHECK(same(c));
    b = std::move(c);
    CHECK(same(b));
}

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

TEST_CASE_TEMPLATE("every value of an enumeration has a name that leads back to it", Kind, actuator_kind,
                   algorithm_kind, easing_kind, edge_kind, envelope_kind, error_kind, faces_kind, format_kind,
                   io_kind, log_kind, note_kind, observer_kind, outside_kind, overlap_kind, phantom_kind,
                   phase_kind, pull_kind, reason_kind, scale_kind, start_from_kind, start_kind, state_kind,
                   texture_kind, timing_kind, together_kind, wait_kind, waveform_kind)
{
    std::set<std::string> names;
    for (const Kind k : all_values<Kind>()) {
        const std::string name(to_string(k));
        CHECK(names.insert(name).second);
        CHECK(from_string<Kind>(name) == k);
    }
    CHECK(names.size() >= 2);
    const std::string said = caught_message([] { return from_string<Kind>("no such name"); });
    for (const std::string& name : names)
        has(said, name);
}

TEST_CASE("an unknown value of an enumeration is named unknown")
{
    CHECK(to_string(static_cast<phantom_kind>(99)) == "unknown");
    CHECK(to_string(static_cast<state_kind>(99)) == "unknown");
}

// Reading moved-from objects is the subject of these tests.
// NOLINTBEGIN(bugprone-use-after-move,hicpp-invalid-access-moved)

TEST_CASE("a moved-from path, trajectory, layout or score keeps its value")
{
    stays_usable(line(), line(), [](const path& p) {
        return p.length_mm() == 50.0 && p.at(25.0) == point{20.0, 15.0} && p.meets_x(20.0).size() == 1 &&
               p.svg() == line().svg();
    });
    stays_usable(trajectory::along(line(), 1.0), trajectory::along(line(), 1.0), [](const trajectory& t) {
        return t.duration_s() == 1.0 && t.length_mm() == 50.0 && t.position(0.5) == point{20.0, 15.0} &&
               t.intensity(0.5) == 1.0 && t.meets_y(15.0).size() == 1 &&
               t.with_duration(2.0).with_intensity(0.5).duration_s() == 2.0;
    });
    stays_usable(layout(palm()), layout(palm()), [](const layout& l) {
        return l.places().size() == 9 && l.contains({20.0, 20.0}) && l.nearest({-5.0, 0.0}) == point{} &&
               l.pitch_mm() == 20.0 && !l.faces().empty();
    });
    const score s = random_score(1, 3);
    stays_usable(s, s, [&s](const score& m) {
        return m.frames() == s.frames() && m.channels() == 9 && m.rate() == rate && m.starts().size() == 1 &&
               m.plans().size() == 1 && rendered(m, format_kind::s16) == rendered(s, format_kind::s16);
    });
}

TEST_CASE("a moved-from renderer reports it, and can be assigned to")
{
    const score s = tone(0.01);
    std::vector<std::byte> out(480 * 9 * 2);
    renderer a(s, format_kind::s16);
    renderer b(std::move(a));
    has(caught_message([&] { a.process(out); }), "renderer: it was moved from (use the one");
    has(caught_message([&] { return a.position(); }), "renderer: it was moved from");
    b.process(out);
    CHECK(out == rendered(s, format_kind::s16));
    a = std::move(b);
    CHECK(a.position() == 480);
    CHECK_THROWS_AS(b.process(out), error);
    b = renderer(s, format_kind::s16);
    CHECK(b.position() == 0);
}

TEST_CASE("a moved-from live stroke feeds the same stroke")
{
    clocked_player p;
    live_stroke a = p.begin({.timeout_s = 86400.0});
    live_stroke b(std::move(a));
    CHECK(a.to(1.0, 1.0));
    CHECK(b.counts().points == 1);
    CHECK(a.id() == b.id());
    a.end();
    CHECK_FALSE(b.open());
    CHECK(p.wait(b.id())->state == state_kind::finished);
    p.stop();
}

// NOLINTEND(bugprone-use-after-move,hicpp-invalid-access-moved)

TEST_CASE("a refusal of the system is nested with its errno")
{
    const folder here;
    CHECK(system_cause([&] { return load_setup(here / "none.toml"); }) == ENOENT);
    CHECK(system_cause([&] { return load_strokes(here / "none.csv"); }) == ENOENT);
    CHECK(system_cause([&] { write_wav(tone(0.001), format_kind::s16, "/dev/full"); }) == ENOSPC);
    CHECK(system_cause([] { return open_alsa({.pcm = "no-such-pcm", .channels = 2}); }) == ENOENT);
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
    const std::string cause = own_cause([&] { return load_setup(outer); });
    has(cause, "none.toml: No such file or directory");
    CHECK(os_code([&] { return load_setup(outer); }) == ENOENT);
    const auto sound = here.write("s.toml", "[stroke]\npoints = [[0, 0], [9, 0]]\nduration_s = 1\n"
                                            "waveform = \"./none.wav\"\n");
    CHECK(os_code([&] { return load_strokes(sound); }) == ENOENT);
    const std::string geometry =
        own_cause([] { return parse_strokes_toml("[stroke]\npath = \"M 0 0 X\"\nduration_s = 1\n", "s"); });
    CHECK(!geometry.empty());
}

TEST_CASE("an error without a cause nests nothing")
{
    CHECK(own_cause([] { return preset_stroke("no-such"); }).empty());
    CHECK(system_cause([] { return preset_stroke("no-such"); }) == 0);
}

} // namespace values_test
