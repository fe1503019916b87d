// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_svg_test {

using tactor::point;
using tactor::stroke;

namespace {

const double pi = std::numbers::pi;

std::vector<stroke> parse(const std::string& svg)
{
    return tactor::parse_strokes_svg(svg, "a.svg");
}

// A shape in a document of millimetres.
stroke one(const std::string& shape, const std::string& attributes = {})
{
    std::vector<stroke> all = parse(fmt::format("<svg {}>{}</svg>", attributes, shape));
    REQUIRE(all.size() == 1);
    return all.front();
}

point at(const stroke& s, double part)
{
    return s.motion.position(part * s.motion.duration_s());
}

void check_near(point got, point want, double within = 1e-9)
{
    CAPTURE(got.x_mm);
    CAPTURE(got.y_mm);
    CAPTURE(want.x_mm);
    CAPTURE(want.y_mm);
    CHECK(tactor::distance_mm(got, want) <= within);
}

std::string refusal(const std::string& svg)
{
    return caught_message([&] { parse(svg); });
}

} // namespace

TEST_CASE("each shape is a stroke at the default speed")
{
    const stroke s = one("<path id='left' d='M 0 10 L 40 30'/>");
    CHECK(s.name == "left");
    CHECK(s.motion.duration_s() == doctest::Approx(s.motion.length_mm() / 60.0));
    CHECK_FALSE(s.start_s.has_value());
    check_near(at(s, 0.5), {20.0, 20.0}, 1e-12);

    CHECK(one("<line x1='0' y1='0' x2='3' y2='4'/>").motion.length_mm() == 5.0);
    CHECK(one("<line x2='3' y2='4'/>").name == "line");
    CHECK(one("<polyline points='0,0 3,0 3,4'/>").motion.length_mm() == 7.0);
    CHECK(one("<polygon points='0 0,3 0,3 4'/>").motion.length_mm() == 12.0);
    const stroke circle = one("<circle cx='20' cy='20' r='16'/>");
    CHECK(circle.motion.length_mm() == doctest::Approx(32.0 * pi));
    check_near(at(circle, 0.0), {36.0, 20.0});
    check_near(at(circle, 0.25), {20.0, 36.0});
    const stroke ellipse = one("<ellipse cx='1' cy='2' rx='2' ry='1'/>");
    CHECK(ellipse.motion.length_mm() == doctest::Approx(9.688448220547675));
    check_near(at(ellipse, 0.5), {-1.0, 2.0});
}

TEST_CASE("rectangles, sharp and round")
{
    const stroke sharp = one("<rect x='1' y='2' width='30' height='20'/>");
    CHECK(sharp.motion.length_mm() == 100.0);
    check_near(at(sharp, 0.3), {31.0, 2.0});
    const stroke round = one("<rect width='30' height='20' rx='5'/>");
    CHECK(round.motion.length_mm() == doctest::Approx(60.0 + 10.0 * pi));
    check_near(at(round, 0.0), {5.0, 0.0});
    check_near(at(round, (20.0 + 2.5 * pi) / (60.0 + 10.0 * pi)), {30.0, 5.0});
    CHECK(one("<rect width='30' height='20' rx='99' ry='99'/>").motion.length_mm() < 100.0);
    CHECK(one("<rect width='30' height='20' rx='5' ry='0'/>").motion.length_mm() == 100.0);
    CHECK(one("<rect width='30' height='20' rx='auto' ry='5'/>").motion.length_mm() ==
          doctest::Approx(60.0 + 10.0 * pi));
}

TEST_CASE("subpaths are strokes one after the other")
{
    const auto all =
        parse("<svg><path id='two' d='M 0 0 H 10 M 0 5 v 20 z'/><line x2='6' data-start-s='9'/></svg>");
    REQUIRE(all.size() == 3);
    CHECK(all[0].name == "two-1");
    CHECK(all[1].name == "two-2");
    CHECK(all[1].motion.length_mm() == 40.0);
    CHECK(all[2].start_s == 9.0);
    CHECK_FALSE(all[1].start_s.has_value());
}

TEST_CASE("data attributes give time, pace, intensity and carrier")
{
    const stroke s = one("<line x2='6' data-duration-s='1.5' data-start-s='0.25' data-intensity='0.5' "
                         "data-carrier-hz='200'/>");
    CHECK(s.motion.duration_s() == 1.5);
    CHECK(s.start_s == 0.25);
    CHECK(s.motion.intensity(1.0) == 0.5);
    CHECK(s.sound.carrier_hz == 200.0);
    CHECK(one("<line x2='6' data-speed-mm-s='12'/>").motion.duration_s() == 0.5);
    // A group's pace holds for its shapes.
    CHECK(one("<g data-speed-mm-s='12'><g><line x2='6'/></g></g>").motion.duration_s() == 0.5);
    CHECK(one("<g data-speed-mm-s='12'><line x2='6' data-speed-mm-s='6'/></g>").motion.duration_s() == 1.0);
    CHECK(one("<g data-speed-mm-s='12'><line x2='6' data-duration-s='3'/></g>").motion.duration_s() == 3.0);
    const auto shared = parse("<svg><path d='M0 0h10M0 5h30' data-duration-s='4' data-start-s='1'/></svg>");
    REQUIRE(shared.size() == 2);
    CHECK(shared[0].motion.duration_s() == doctest::Approx(1.0));
    CHECK(shared[1].motion.duration_s() == doctest::Approx(3.0));
    CHECK(shared[0].start_s == 1.0);
    CHECK_FALSE(shared[1].start_s.has_value());
}

TEST_CASE("without a physical size, a user unit is a millimetre")
{
    const std::string line = "<line x1='10' x2='20'/>";
    for (const char* size :
         {"", "width='400' height='300'", "viewBox='-5 -5 50 50'", "width='100%' viewBox='0 0 9 9'",
          "width='100' height='50' viewBox='0 0 10 10'"}) {
        CAPTURE(size);
        const stroke s = one(line, size);
        check_near(at(s, 0.0), {10.0, 0.0});
        check_near(at(s, 1.0), {20.0, 0.0});
    }
    check_near(at(one("<line x2='1cm'/>"), 1.0), {10.0, 0.0});
}

TEST_CASE("with a physical size, the drawing has that size")
{
    const auto end = [](const std::string& size,
                        const std::string& line = "<line x1='10' y1='10' x2='20' y2='10'/>") {
        return at(one(line, size), 1.0);
    };
    check_near(end("width='50mm' height='50mm' viewBox='0 0 50 50'"), {20.0, 10.0});
    check_near(end("width='50mm' height='50mm' viewBox='0 0 100 100'"), {10.0, 5.0});
    check_near(end("width='5cm' viewBox='0 0 50 50'"), {20.0, 10.0});
    check_near(end("height='50mm' viewBox='0 0 50 50'"), {20.0, 10.0});
    check_near(end("width='1in' height='1in' viewBox='0 0 96 96'"), {20.0 * 25.4 / 96.0, 10.0 * 25.4 / 96.0});
    check_near(end("width='72pt' height='6pc' viewBox='0 0 25.4 25.4'"), {20.0, 10.0});
    check_near(end("width='96px' height='96px' viewBox='0 0 25.4 25.4'"), {20.0, 10.0});
    check_near(end("width='50mm' height='50mm'"), {20.0 * 25.4 / 96.0, 10.0 * 25.4 / 96.0});
    check_near(end("width='50mm' height='50mm' viewBox='-5 -10 50 50'"), {25.0, 20.0});
    check_near(end("width='50MM' height='200q' viewBox='0 0 50 50'"), {20.0, 10.0});
    check_near(end("style='width:50mm;HEIGHT:50mm' viewBox='0 0 100 100'"), {10.0, 5.0});
    check_near(end("width='50mm' height='50mm' style='width:100%;height:auto' viewBox='0 0 50 50'"),
               {20.0, 10.0});
    // Units inside are physical as well.
    check_near(end("width='50mm' height='50mm'", "<line x2='20mm'/>"), {20.0, 0.0});
}

TEST_CASE("a view box of another shape is in the middle; other alignments are warned of")
{
    const auto drawn = [](const std::string& aspect, const std::string& box = "0 0 10 10") {
        return one("<line x2='10' y2='10'/>",
                   fmt::format("width='100mm' height='50mm' viewBox='{}' {}", box, aspect));
    };
    for (const char* followed :
         {"", "preserveAspectRatio='xMidYMid'", "preserveAspectRatio='xMidYMid meet'"}) {
        check_near(at(drawn(followed), 1.0), {75.0, 50.0});
        CHECK(drawn(followed).warnings.empty());
    }
    const stroke other = drawn("preserveAspectRatio='xMinYMin'");
    check_near(at(other, 1.0), {75.0, 50.0});
    CHECK(other.warnings ==
          std::vector<std::string>{"a.svg:1:2: preserveAspectRatio of <svg> is not supported: a shape that "
                                   "it hides or moves plays as if it were not there"});
    CHECK(drawn("preserveAspectRatio='none'", "0 0 200 100").warnings.empty());
    const std::string flat = "width='80' height='40' preserveAspectRatio='none' viewBox=";
    CHECK(one("<circle r='3'/>", flat + "'0 0 40 40'").warnings.size() == 1);
    CHECK(one("<circle r='3'/>", flat + "'0 0 4 2'").warnings.empty());
}

TEST_CASE("a size that cannot be read and a transform of the outermost svg are warned of")
{
    CHECK(one("<circle r='3'/>", "width='calc(2em)' height='9'")
              .warnings.at(0)
              .find("width of <svg> is not supported") != std::string::npos);
    const stroke s = one("<line x1='1' x2='10'/>", "transform='scale(3)'");
    check_near(at(s, 1.0), {10.0, 0.0});
    CHECK(s.warnings.at(0).find("transform of <svg> is not supported") != std::string::npos);
}

TEST_CASE("transforms, in lists and nested")
{
    const auto end = [](const std::string& transform) {
        return at(one(fmt::format("<line x1='1' x2='10' transform='{}'/>", transform)), 1.0);
    };
    check_near(end("translate(5)"), {15.0, 0.0});
    check_near(end("translate(5,6)"), {15.0, 6.0});
    check_near(end("scale(2)"), {20.0, 0.0});
    check_near(end("scale(2 -3)"), {20.0, 0.0});
    check_near(end("rotate(90)"), {0.0, 10.0}, 1e-15);
    check_near(end("rotate(90, 10, 10)"), {20.0, 10.0}, 1e-14);
    check_near(end("skewX(45)"), {10.0, 0.0});
    check_near(end("skewY(45)"), {10.0, 10.0});
    check_near(end("matrix(1 2 3 4 5 6)"), {15.0, 26.0});
    check_near(end(" translate(5) , scale (2)\n"), {25.0, 0.0});
    check_near(end("scale(2) translate(5)"), {30.0, 0.0});
    check_near(
        at(one("<g transform='translate(1,2)'><g transform='scale(2)'><line x1='1' x2='10'/></g></g>"), 1.0),
        {21.0, 2.0});
    // A skewed circle has the length of its ellipse.
    const stroke s = one("<circle r='10' transform='skewX(30)'/>");
    check_near(at(s, 0.0), {10.0, 0.0});
    double chords = 0.0;
    for (int k = 0; k < 100000; ++k) {
        const auto p = [](int i) {
            const double a = 2.0 * pi * i / 100000.0;
            return point{10.0 * std::cos(a) + std::tan(pi / 6.0) * 10.0 * std::sin(a), 10.0 * std::sin(a)};
        };
        chords += tactor::distance_mm(p(k), p(k + 1));
    }
    CHECK(s.motion.length_mm() == doctest::Approx(chords).epsilon(1e-8));
}

TEST_CASE("nested svg elements, symbols and lengths in per cent are warned of")
{
    const std::string line = "<line x2='7'/>";
    for (const auto& [other, part] :
         {std::pair{"<svg viewBox='0 0 10 10'><line x2='3'/></svg>", "<svg> does not play"},
          std::pair{
              "<symbol id='s'><line x2='3'/></symbol><use href='#s'/>",
              "<use> refers to <symbol> 's', which does not play (refer to a shape or a group): left out"},
          std::pair{"<rect width='100%' height='100%'/>", "unit '%' is unknown"}}) {
        const stroke s = one(other + line);
        CHECK(s.motion.length_mm() == 7.0);
        REQUIRE(s.warnings.size() == 1);
        CHECK(s.warnings.front().find(part) != std::string::npos);
    }
}

TEST_CASE("use draws its target; definitions alone draw nothing")
{
    const std::string defs = "<defs><path id='p' d='M 1 0 H 10'/></defs>";
    check_near(at(one(defs + "<use href='#p' x='5' y='6'/>"), 1.0), {15.0, 6.0});
    check_near(at(one(defs + "<use xlink:href='#p' transform='scale(2)' x='5'/>"), 1.0), {30.0, 0.0});
    CHECK(one(defs + "<use id='u' href='#p'/>").name == "p");
    for (const char* holder : {"defs", "symbol", "clipPath", "mask", "marker", "pattern"}) {
        CAPTURE(holder);
        CHECK(one(fmt::format("<{0}><line x2='3'/></{0}><line x2='7'/>", holder)).motion.length_mm() == 7.0);
    }
    CHECK(one("<line x2='3' display='none'/><line x2='7'/>").motion.length_mm() == 7.0);
    CHECK(one("<g style='fill:red; display : none'><line x2='3'/></g><line x2='7'/>").motion.length_mm() ==
          7.0);
    for (const char* hidden : {"visibility='hidden'", "visibility=' collapse '", "style='visibility:hidden'",
                               "style='visibility: visible; visibility : hidden !important'",
                               "visibility='visible' style='stroke:red;visibility:collapse;'"}) {
        CAPTURE(hidden);
        CHECK(one(fmt::format("<line x2='3' {}/><line x2='7'/>", hidden)).motion.length_mm() == 7.0);
        CHECK(one(fmt::format("<g {}><line x2='3'/><line x2='7' visibility='visible'/></g>", hidden))
                  .motion.length_mm() == 7.0);
        // A hidden shape need not be drawable.
        CHECK(one(fmt::format("<g {}><line x2='x'/></g><line x2='7'/>", hidden)).motion.length_mm() == 7.0);
    }
    CHECK(one("<g display='none'><line x2='3' display='inline' visibility='visible'/></g><line x2='7'/>")
              .motion.length_mm() == 7.0);
    CHECK(one("<g visibility='hidden'><g visibility='inherit'><line x2='3'/></g></g><line x2='7'/>")
              .motion.length_mm() == 7.0);
    CHECK(
        one("<svg:g xmlns:svg='http://www.w3.org/2000/svg'><svg:line x2='7'/></svg:g>").motion.length_mm() ==
        7.0);
    CHECK(one("<x:line x2='3'/><line x2='7'/>").motion.length_mm() == 7.0);
}

TEST_CASE("shapes that draw nothing are left out with a warning if there are others")
{
    for (const char* nothing : {"<path d=''/>",
                                "<path d='none'/>",
                                "<path/>",
                                "<path d='M 1 1'/>",
                                "<path d='M5 5Z'/>",
                                "<path d='M 1 1 L 1 1'/>",
                                "<rect width='0' height='3'/>",
                                "<rect width='-1' height='3'/>",
                                "<circle r='0'/>",
                                "<circle r='-1'/>",
                                "<line/>",
                                "<polyline points='1 1'/>",
                                "<polygon/>",
                                "<polygon points='1 1'/>",
                                "<polygon points='1 1 1 1'/>",
                                "<line x2='3' transform='scale(0)'/>",
                                "<use href='other.svg#a'/>",
                                "<use href='#a'/>",
                                "<line x2='calc(1px + 2px)'/>",
                                "<line x2='3em'/>"}) {
        CAPTURE(nothing);
        const stroke s = one(std::string(nothing) + "<line x2='7'/>");
        CHECK(s.motion.length_mm() == 7.0);
        REQUIRE(s.warnings.size() == 1);
        CHECK(s.warnings[0].find("a.svg:1:") == 0);
        CHECK(s.warnings[0].find("): left out") != std::string::npos);
        CHECK(refusal(fmt::format("<svg>{}</svg>", nothing)).find("a.svg:1:") == 0);
    }
    CHECK(one("<path d='M 0 0 h 7 M 3 3'/>").motion.length_mm() == 7.0);
    const stroke s = one("<path d='M 0 0 h 3 v 4 z M 5 5 z' data-duration-s='2'/>");
    CHECK(s.motion.duration_s() == 2.0);
    CHECK(s.warnings ==
          std::vector<std::string>{"a.svg:1:8: <path>: a subpath has no length (it draws a point): "
                                   "left out"});
    CHECK(parse("<svg><circle r='-1'/><line/><circle r='-2'/><line x2='7'/></svg>").front().warnings.size() ==
          2);
}

TEST_CASE("shapes that nobody sees are said")
{
    for (const char* unseen :
         {"fill='none'", "style='fill:None'", "opacity='0'", "style='fill:none;stroke:none'"})
        CHECK(
            one("<g " + std::string(unseen) + "><line x2='7'/></g>").warnings ==
            std::vector<std::string>{"a.svg:1:" + std::to_string(12 + std::string(unseen).size()) +
                                     ": <line> has neither fill nor stroke, or no opacity: it still plays"});
    CHECK(one("<g fill='none'><line x2='7' stroke='red'/></g>").warnings.empty());
}

TEST_CASE("equal shapes in one place are said")
{
    const std::string d = "<path d='M 0 0 C 1 2 3 4 5 6'/>";
    CHECK(parse("<svg>" + d + d + d + "</svg>").front().warnings ==
          std::vector<std::string>{"a.svg:1:38: <path> has the same shape as an earlier element (and 1 "
                                   "element more): it plays again"});
    CHECK(parse("<svg>" + d + "<g transform='translate(1)'>" + d + "</g></svg>").front().warnings.empty());
    CHECK(parse("<svg>" + d + "<path data-start-s='3' d='M 0 0 C 1 2 3 4 5 6'/></svg>")
              .front()
              .warnings.empty());
}

TEST_CASE("shapes ease")
{
    const auto s = tactor::parse_strokes_svg(
        "<svg data-easing=\"minimum-jerk\"><path d=\"M 0 0 H 40\" "
        "data-duration-s=\"2\"/><path d=\"M 0 0 H 40\" data-easing=\"linear\"/></svg>",
        "d.svg");
    CHECK(s[0].motion.duration_s() == 2.0);
    CHECK(s[0].motion.position(0.5).x_mm == doctest::Approx(40.0 * 0.103515625));
    CHECK(s[1].motion.position(0.25 * s[1].motion.duration_s()).x_mm == doctest::Approx(10.0));
}

} // namespace stroke_svg_test
