// SPDX-License-Identifier: MIT
// From each kind of source to strokes, plans and scores.
#include "session/piece.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "caught.hpp"
#include "folder.hpp"

namespace piece_test {

using namespace tactor;
using namespace tactor::session;

namespace {

const array palm = preset_array("palm-3x3");
const layout faces(palm);

render_options sound(double level_dbfs = -20.0)
{
    render_options r;
    r.level_dbfs = level_dbfs;
    r.channels = palm.channels();
    return r;
}

std::vector<float> samples(const score& s)
{
    std::vector<float> out(s.frames() * s.channels());
    renderer(s, format_kind::float32).process(std::as_writable_bytes(std::span(out)));
    return out;
}

float peak(const std::vector<float>& all, std::size_t from = 0)
{
    float most = 0.0F;
    for (std::size_t i = from; i < all.size(); ++i)
        most = std::max(most, std::abs(all[i]));
    return most;
}

piece read(source from, const options::option_values& o = {})
{
    return read_piece(std::move(from), "it", faces, o);
}

/// A line of 40 mm in 0.8 s.
std::vector<std::pair<std::string, source>> lines(const folder& f)
{
    static const std::string toml = "[stroke]\npath = \"M 0 20 H 40\"\nduration_s = 0.8\n";
    static const std::string csv = "t_s,x_mm,y_mm\n5,0,20\n5.8,40,20\n";
    const std::vector<timed_point> points{{3.0, {0.0, 20.0}}, {3.8, {40.0, 20.0}}};
    return {{"path", path_data{"M 0 20 H 40"}},
            {"points", points},
            {"toml", make_source("toml", toml)},
            {"csv", make_source("csv", csv)},
            {"file", stroke_file{f.write("line.toml", toml)}},
            {"strokes", parse_strokes_toml(toml, "line")}};
}

} // namespace

TEST_CASE("a source of any kind becomes the same stroke")
{
    const folder f;
    const options::option_values o{.duration_s = 0.8};
    for (const auto& [kind, from] : lines(f)) {
        CAPTURE(kind);
        const piece p = read(from, o);
        CHECK(p.name == "it");
        REQUIRE(p.strokes.size() == 1);
        const trajectory& m = p.strokes.front().motion;
        CHECK(m.duration_s() == doctest::Approx(0.8));
        for (const double t : {0.0, 0.2, 0.5, 0.8}) {
            CHECK(m.position(t).x_mm == doctest::Approx(50.0 * t));
            CHECK(m.position(t).y_mm == 20.0);
        }
    }
    CHECK(read(stroke_name{"circle"}).strokes.front().name == "circle");
    CHECK(read(make_source("stroke", "park2016-1")).strokes.front().name == "park2016-1");
    CHECK(read_strokes(path_data{"M 0 0 H 30"}, "it", {}).front().motion.duration_s() ==
          doctest::Approx(0.5));
}

TEST_CASE("clients can send the text of each format, a name, a path and points")
{
    std::vector<std::string_view> names{"stroke", "path", "points"};
    for (const detail::stroke_format* k : detail::stroke_formats())
        names.push_back(k->name);
    CHECK(source_names() == names);
    for (const detail::stroke_format* k : detail::stroke_formats()) {
        const std::string text = "no such thing";
        const source made = make_source(k->name, text);
        CHECK(std::get<format_text>(made).format == k);
        // A text in memory is named, and must not name files.
        CHECK(
            caught_message([&] { static_cast<void>(read_strokes(made, "sent", {})); }).starts_with("sent:"));
    }
    const std::string with_file = "[stroke]\npath = 'M 0 0 H 9'\nwaveform = 'a.wav'\n";
    CHECK(caught_message([&] {
              static_cast<void>(read_strokes(make_source("toml", with_file), "sent", {}));
          }).starts_with("sent:3"));
}

TEST_CASE("strokes, their plans and plans that are kept make the same samples")
{
    const std::string two = "[[stroke]]\npath = 'M 5 5 H 35'\nduration_s = 0.4\n"
                            "[[stroke]]\npath = 'M 35 35 H 5'\nduration_s = 0.4\n";
    for (const bool compensate : {false, true}) {
        options::option_values o;
        o.compensate = compensate;
        CAPTURE(compensate);
        piece drawn = read(make_source("toml", two), o);
        piece planned = drawn;
        std::vector<std::size_t> steps;
        plan_piece(planned, palm, faces, o, [&](std::size_t i) { steps.push_back(i); });
        CHECK(steps == std::vector<std::size_t>{0, 1});
        REQUIRE(planned.plans.size() == 2);
        CHECK(planned.moved.size() == (compensate ? 2 : 0));
        const std::vector<float> kept = samples(make_score(std::as_const(planned), palm, sound()));
        CHECK(planned.plans.size() == 2);
        steps.clear();
        CHECK(samples(make_score(drawn, palm, faces, o, sound(),
                                 [&](std::size_t i) { steps.push_back(i); })) == kept);
        CHECK(steps == std::vector<std::size_t>{0, 1, 2});
        piece again = read(planned, o);
        CHECK(again.plans.size() == 2);
        CHECK(samples(make_score(again, palm, faces, o, sound())) == kept);
        CHECK(again.plans.empty());
        CHECK(peak(kept) > 0.05F);
    }
}

TEST_CASE("a plan that repeats has its samples again after each round")
{
    piece p = read(path_data{"M 5 5 H 35"}, {.duration_s = 0.3});
    plan_piece(p, palm, faces, {});
    const plan& one = p.plans.front().plan;
    const std::size_t round = 48000 * palm.channels();
    const std::vector<float> once = samples(make_score(one, palm, sound(), 1, 1.0));
    const std::vector<float> all = samples(make_score(one, palm, sound(), 3, 1.0));
    REQUIRE(all.size() == once.size() + 2 * round);
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(std::equal(once.begin(), once.end(), all.begin() + static_cast<std::ptrdiff_t>(k * round)));
}

TEST_CASE("samples of a file are the score, and are read for it")
{
    const folder f;
    piece drawn = read(path_data{"M 5 5 H 35"}, {.duration_s = 0.3});
    const score s = make_score(drawn, palm, faces, {}, sound());
    const auto file = f.path() / "own.wav";
    write_wav(s, format_kind::float32, file);
    piece own = read(samples_file{file});
    CHECK(own.strokes.empty());
    CHECK(samples(make_score(own, palm, faces, {}, sound())) == samples(s));
    piece none = read(samples_file{f.path() / "none.wav"});
    CHECK(caught_message([&] {
              static_cast<void>(make_score(none, palm, faces, {}, sound()));
          }).find("none.wav") != std::string::npos);
}

TEST_CASE("plans with sounds of their own keep their levels in one score")
{
    piece p = read(path_data{"M 0 0 H 40"}, {.duration_s = 0.3});
    plan_piece(p, palm, faces, {});
    placed_plan first = p.plans.front();
    placed_plan second = first;
    second.start_s = 1.0;
    const joined_score both = join_plans(palm, {{first, sound(-20.0)}, {second, sound(-32.0)}});
    CHECK(both.sound.level_dbfs == -20.0);
    CHECK(both.levels == std::vector{-20.0, -32.0});
    const std::vector<float> all = samples(both.samples);
    // The first burst is on a tactor. -20 dBFS is a tenth of full scale; 12 dB less is a factor of
    // 10^(-12/20).
    CHECK(peak(all) == doctest::Approx(0.1).epsilon(1e-3));
    CHECK(peak(all, 48000 * palm.channels()) == doctest::Approx(0.1 * std::pow(10.0, -0.6)).epsilon(1e-3));

    render_options other = sound();
    other.rate = 44100;
    CHECK(caught_message([&] {
              static_cast<void>(join_plans(palm, {{first, sound()}, {second, other}}));
          }) ==
          "rate: the plans have different values, 48000 Hz and 44100 Hz (give rate= here, for all plans)");
    CHECK(caught_message([] { static_cast<void>(join_plans(palm, {})); }) ==
          "plans: there are none (give at least one)");
}

TEST_CASE("the margin of a file that leaves no space is said of the file")
{
    const std::string text = "[stroke]\npath = 'M 0 0 H 9'\nfit = true\nfit_margin_mm = 30\n";
    CHECK(caught_message([&] { static_cast<void>(read(make_source("toml", text))); }) ==
          "it: fit_margin_mm: 30 mm on each side leaves no space in the array (use less than 20 mm)");
}

} // namespace piece_test
