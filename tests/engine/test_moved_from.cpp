// SPDX-License-Identifier: MIT
// Moved-from objects: they can be destroyed, assigned to and used, keep their value or report the fault.
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/percept.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>

#include "clock_runner.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace moved_from_test {

using namespace tactor;
using namespace tactor::test;

// Reading moved-from objects is the subject of these tests.
// NOLINTBEGIN(bugprone-use-after-move,hicpp-invalid-access-moved)

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

template <typename Call>
std::string refused(Call c)
{
    try {
        c();
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
    return "no error";
}

} // namespace

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

// Only the library makes handles, so that none is empty.
static_assert(!std::is_constructible_v<path, std::shared_ptr<const path::impl>>);
static_assert(!std::is_constructible_v<trajectory, std::shared_ptr<const trajectory::impl>>);
static_assert(!std::is_constructible_v<live_stroke, std::shared_ptr<live_stroke::impl>>);

TEST_CASE("a player without a sink is refused")
{
    has(refused([] { player(nullptr, palm()); }), "no sink");
}

TEST_CASE("a moved-from renderer reports it, and can be assigned to")
{
    const score s = tone(0.01);
    std::vector<std::byte> out(480 * 9 * 2);
    renderer a(s, format_kind::s16);
    renderer b(std::move(a));
    has(refused([&] { a.process(out); }), "renderer: it was moved from (use the one");
    has(refused([&] { static_cast<void>(a.position()); }), "renderer: it was moved from");
    b.process(out);
    CHECK(out == rendered(s, format_kind::s16));
    a = std::move(b);
    CHECK(a.position() == 480);
    CHECK_THROWS_AS(b.process(out), error);
    b = renderer(s, format_kind::s16);
    CHECK(b.position() == 0);
}

TEST_CASE("moved-from plain values are empty, and refused where something is needed")
{
    array a = palm();
    const array b(std::move(a));
    CHECK(b.channels() == 9);
    CHECK(a.channels() == 0);
    CHECK_FALSE(find_grid(a).has_value());
    const stroke s{"line", trajectory::along(line(), 1.4)};
    CHECK_THROWS_AS(validate(a), error);
    CHECK_THROWS_AS(layout{a}, error);
    CHECK_THROWS_AS(make_plan(a, s), error);
    CHECK_THROWS_AS(score(a, {}, {}), error);

    plan p = make_plan(b, s);
    const plan q(std::move(p));
    CHECK(q.bursts.size() == 21);
    CHECK(p.bursts.empty());
    CHECK(predict_percept(b, s, p).size() == 1401);
    CHECK(summarise(std::vector<percept_sample>{}).silent_share == 0.0);
    CHECK(score(b, {{p}}, {}).channels() == 9);

    stroke t = s;
    const stroke u(std::move(t));
    CHECK(make_plan(b, t).bursts.size() == 21);
    CHECK(make_plan(b, u).bursts.size() == 21);

    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    plan flowing = make_plan(b, s, o);
    const plan kept(std::move(flowing));
    CHECK(kept.curve);
    CHECK(kept.curve == flowing.curve);
    CHECK(score(b, {{flowing}}, {}).channels() == 9);
}

TEST_CASE("a moved-from or copied error is still an error")
{
    error a(error_kind::runtime, "a subject that is longer than any small string", "why it was",
            "what to do");
    const error b(a);
    const error c(std::move(a));
    CHECK(b.why() == "why it was");
    CHECK(c.hint() == "what to do");
    CHECK(a.kind() == error_kind::runtime);
    CHECK(a.what() != nullptr);
    CHECK(a.why().size() + a.hint().size() + a.subject().size() < 100);
    a = c;
    CHECK(a.subject() == c.subject());
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
    const auto r = p.wait(b.id());
    REQUIRE(r);
    CHECK(r->state == state_kind::finished);
    p.stop();
}

TEST_CASE("a player takes its sink and lines, and the moved-from ones can be used again")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::unique_ptr<sink> out = alsa::adopt(dac.pcm(), nine());
    player_lines lines;
    player p(std::move(out), palm(), patient(), std::move(lines));
    CHECK_THROWS_AS(player(std::move(out), palm(), patient(), std::move(lines)), error);
    score s = tone(0.01);
    const score other(std::move(s));
    CHECK(p.wait(p.submit(s))->state == state_kind::finished);
    p.stop();
}

// NOLINTEND(bugprone-use-after-move,hicpp-invalid-access-moved)

} // namespace moved_from_test
