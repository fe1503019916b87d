// SPDX-License-Identifier: MIT
// Sync markers on a spare channel.
#include <algorithm>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "pieces.hpp"
#include "synth/mix/mixer.hpp"

namespace marker_test {

using namespace tactor;
using namespace pieces;

namespace {

render_options marked(unsigned channel, unsigned channels)
{
    render_options o;
    o.channels = channels;
    o.marker_channel = channel;
    return o;
}

score two_strokes(const render_options& o)
{
    const plan p = make_plan({make_burst(0.0, 0.05, {{0, 1.0}, {1, 0.5}})});
    return {row(3), {{p, {}}, {p, 0.1234}}, o};
}

} // namespace

TEST_CASE("a marker is at each stroke's first frame, for its length, at full scale")
{
    const score s = two_strokes(marked(4, 6));
    const std::vector<double> x = channel(s, 4);
    REQUIRE(x.size() == s.frames());
    for (std::size_t i = 0; i < x.size(); ++i) {
        bool on = false;
        for (const std::uint64_t start : s.starts())
            on = on || (i >= start && i < start + 240);
        REQUIRE(x[i] == (on ? 1.0 : 0.0));
    }
    CHECK(s.starts()[1] == 5923);
    render_options plain = marked(4, 6);
    plain.marker_channel.reset();
    for (const unsigned c : {0U, 1U, 2U, 3U, 5U})
        CHECK((channel(s, c) == channel(two_strokes(plain), c)));
}

TEST_CASE("markers have the same bytes for any blocks, in every format, and two at once are one")
{
    std::mt19937_64 random(2);
    const plan p = make_plan({make_burst(0.0, 0.05, {{0, 1.0}})});
    const score s(row(1), {{p, {}}, {p, 0.001}, {p, 0.2}}, marked(1, 2));
    for (const format_kind f : all_formats) {
        const auto whole = render(s, f);
        CHECK((whole == render(
                            s, f, [&] { return 1 + random() % 100; }, s.frames())));
    }
    const std::vector<double> x = channel(s, 1);
    CHECK(*std::max_element(x.begin(), x.end()) == 1.0);
    CHECK(std::count(x.begin(), x.end(), 1.0) == 288 + 240);
}

TEST_CASE("a marker does not make a piece longer and may be longer than it")
{
    render_options o = marked(1, 2);
    o.marker_s = 1.0;
    const score s(row(1), {{make_plan({make_burst(0.0, 0.05, {{0, 1.0}})}), {}}}, o);
    CHECK(s.frames() == 2400);
    CHECK(channel(s, 1).back() == 1.0);
}

TEST_CASE("a marker needs a spare channel that exists")
{
    CHECK_THROWS_WITH_AS(two_strokes(marked(1, 6)),
                         "marker channel 1: it drives tactor 1 (choose a spare channel)", error);
    CHECK_THROWS_WITH_AS(two_strokes(marked(6, 6)),
                         "marker channel 6: there are 6 channels (ask for 7 channels or more)", error);
    for (const double length : {0.0, -1.0, 20.0, std::numeric_limits<double>::quiet_NaN()}) {
        render_options o = marked(4, 6);
        o.marker_s = length;
        CHECK_THROWS_AS(two_strokes(o), error);
    }
}

TEST_CASE("a constant never reaches a tactor")
{
    synth::mixer m(std::vector<double>{1.0, 0.0}, format_kind::float32, 8);
    synth::drive_event e;
    e.length = 100;
    e.drives = 2;
    e.drive[0] = {1.0, 1.0, 0};
    e.drive[1] = {1.0, 1.0, 1};
    CHECK(m.add(e));
    CHECK(m.size() == 0);
    std::vector<float> x(200);
    m.process(100, reinterpret_cast<std::byte*>(x.data()));
    CHECK(std::all_of(x.begin(), x.end(), [](float v) { return v == 0.0F; }));
}

} // namespace marker_test
