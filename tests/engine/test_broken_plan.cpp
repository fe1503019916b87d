// SPDX-License-Identifier: MIT
// Samples that cannot be computed in mid-stroke, as without memory: a stroke that ends early never counts as
// finished.
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "own_curve.hpp"
#include "rig.hpp"

namespace broken_plan_test {

using namespace tactor;
using namespace tactor::test;

namespace {

enum class fault {
    none,
    nan,
    infinite,
    wild,
    below,
    just_above,
    another_tactor,
    twice,
    no_such_tactor,
    throws,
    throws_a_number
};

// A second on tactor 4 that is right while the score is made, and breaks at a time once `broken` is set.
score made(const std::shared_ptr<fault>& broken, double from_s)
{
    plan p;
    p.total_s = p.stroke_duration_s = 1.0;
    p.curve = test::make_curve(1.0, [broken, from_s](double t, burst& out) {
        out.drives = {{4, 0.5}};
        if (t < from_s)
            return;
        switch (*broken) {
        case fault::none:
            return;
        case fault::nan:
            out.drives[0].amplitude = std::numeric_limits<double>::quiet_NaN();
            return;
        case fault::infinite:
            out.drives[0].amplitude = std::numeric_limits<double>::infinity();
            return;
        case fault::wild:
            out.drives[0].amplitude = 1e300;
            return;
        case fault::below:
            out.drives[0].amplitude = -1e300;
            return;
        case fault::just_above:
            out.drives[0].amplitude = 0.500001;
            return;
        case fault::another_tactor:
            out.drives.push_back({5, 0.001});
            return;
        case fault::twice:
            out.drives.push_back({4, 0.5});
            return;
        case fault::no_such_tactor:
            out.drives[0].tactor = 9;
            return;
        case fault::throws:
            throw std::runtime_error("the model has no idea");
        case fault::throws_a_number:
            throw 7;
        }
    });
    return {palm(), p};
}

struct sample {
    fault kind;
    const char* why;
};

constexpr sample samples[] = {
    {fault::nan, "tactor 4 at amplitude nan cannot be rendered"},
    {fault::infinite, "tactor 4 at amplitude inf cannot be rendered"},
    {fault::wild, "tactor 4 at amplitude 1e+300, above the 0.5 that it was planned with"},
    {fault::below, "tactor 4 at amplitude -1e+300, above the 0.5 that it was planned with"},
    {fault::just_above, "tactor 4 at amplitude 0.500001, above the 0.5 that it was planned with"},
    {fault::another_tactor, "tactor 5 at amplitude 0.001, above the 0 that it was planned with"},
    {fault::twice, "tactor 4 after tactor 4"},
    {fault::no_such_tactor, "tactor 9 at amplitude 0.5 cannot be rendered"},
    {fault::throws, "the model has no idea"},
    {fault::throws_a_number, "an exception that is no std::exception"},
};

} // namespace

TEST_CASE("a plan that fails in mid-stroke interrupts the stroke with the reason, and fades where it failed")
{
    for (const unsigned period : {32U, 96U, 1024U}) {
        for (const sample& s : samples) {
            CAPTURE(period);
            CAPTURE(s.why);
            const auto broken = std::make_shared<fault>(fault::none);
            const score music = made(broken, 0.3);
            const std::vector<std::byte> whole = rendered(music, format_kind::s32);
            *broken = s.kind;
            rig_options o;
            o.period = period;
            rig r(o);
            const std::uint64_t base = r.status().written;
            const stroke_id id = r.submit(music);
            r.play_out();
            const stroke_report report = r.end(id);
            CHECK(report.state == state_kind::interrupted);
            CHECK(report.why.find("the plan failed at 0.3") == 0);
            CHECK(report.why.find(s.why) != std::string::npos);
            CHECK(report.started_ns.has_value());
            // Control points up to 0.299 s are right; it is silent there, and fades before that.
            const std::uint64_t good = rate * 299 / 1000;
            CHECK(report.frames <= good);
            CHECK(report.frames + period + o.loop.fade_frames >= good);
            const std::uint64_t same = good - period - 2 * o.loop.fade_frames;
            CHECK(r.captured(base, same) ==
                  std::vector<std::byte>(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(
                                                                            same * r.dac.frame_bytes())));
            r.play(4800);
            CHECK_FALSE(r.first_sound(base + report.frames));
        }
    }
}

TEST_CASE("a plan that exceeds its promise by a rounding does not fail")
{
    double amplitude = 0.5;
    plan p;
    p.total_s = p.stroke_duration_s = 0.1;
    p.curve = test::make_curve(0.1, [&](double, burst& out) { out.drives = {{4, amplitude}}; });
    const score music(palm(), p);
    amplitude = std::nextafter(0.5, 1.0);
    rig r;
    const stroke_id id = r.submit(music);
    r.play_out();
    CHECK(r.end(id).state == state_kind::finished);
}

TEST_CASE("a plan that fails at its first point is interrupted before it sounds")
{
    const auto broken = std::make_shared<fault>(fault::none);
    const score music = made(broken, 0.0);
    *broken = fault::throws;
    rig r;
    const stroke_id now = r.submit(music);
    const stroke_id later = r.submit(music, r.status().written + 9600);
    r.play_out();
    for (const stroke_id id : {now, later}) {
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "the plan failed at 0 s of the stroke: the model has no idea");
        CHECK(r.end(id).frames == 0);
    }
    CHECK_FALSE(r.first_sound());
}

TEST_CASE("a stroke that fails leaves the others alone")
{
    const auto broken = std::make_shared<fault>(fault::none);
    const score music = made(broken, 0.2);
    *broken = fault::nan;
    rig r;
    const stroke_id before = r.submit(tone(0.5));
    const stroke_id fails = r.submit(music);
    const stroke_id after = r.submit(tone(0.1), r.status().written + rate);
    r.play_out();
    CHECK(r.end(before).state == state_kind::finished);
    CHECK(r.end(fails).state == state_kind::interrupted);
    CHECK(r.end(after).state == state_kind::finished);
    // A cancel before the failure counts as a cancel, and a score that fails keeps no place.
    const stroke_id cancelled = r.submit(music);
    r.play(960);
    r.feed.cancel(cancelled);
    r.play_out();
    CHECK(r.end(cancelled).state == state_kind::cancelled);
    CHECK(r.end(cancelled).why.empty());
    for (int n = 0; n < 600; ++n)
        r.submit(music);
    r.play_out();
    CHECK(r.ended.size() == r.last_id);
    CHECK(r.end(r.last()).state == state_kind::interrupted);
}

} // namespace broken_plan_test
