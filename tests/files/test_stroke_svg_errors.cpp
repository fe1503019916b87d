// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_svg_errors_test {

namespace {

std::string refusal(const std::string& svg)
{
    return caught_message([&] { static_cast<void>(tactor::parse_strokes_svg(svg, "a.svg")); });
}

std::string repeated(const std::string& what, int times)
{
    std::string all;
    for (int i = 0; i < times; ++i)
        all += what;
    return all;
}

} // namespace

TEST_CASE("faults of an SVG file are named by line and column")
{
    struct sample {
        const char* svg;
        const char* message;
    };
    const sample samples[] = {
        {"", "a.svg: is empty (strokes are TOML, CSV or SVG"},
        {"t_s,x_mm,y_mm\n0,1,2\n", "a.svg:1:1: is a table (CSV)"},
        {"<svg>", "a.svg:1:5: Start-end tags mismatch"},
        {"<svg>\n <g></svg>", "a.svg:2:"},
        {"<html/>", "a.svg:1:2: <html> is not <svg>"},
        {"<svg/>", "a.svg: no shape in it"},
        {"<svg><text>a</text></svg>", "a.svg: no shape in it"},
        {"<svg>\n<line id='l' x2='3' visibility='hidden'/></svg>",
         "a.svg:2:2: <line> 'l' is hidden, and nothing else draws (take out display, visibility and styles "
         "such as &st0;)"},
        {"<svg><g id='layer' display='none'><line x2='3'/></g></svg>",
         "a.svg:1:7: <g> 'layer' is hidden, and "},
        {"<svg style='display:none'><line x2='3'/></svg>", "a.svg:1:2: <svg> is hidden, and "},
        {"<svg>\n<path id='p' d='M 0 0\n L 1 x'/></svg>",
         "a.svg:3:6: d of <path> 'p': 'x' where L wants a number"},
        {"<svg>\n<path d='L 1 1'/></svg>", "a.svg:2:10: d of <path>: 'L' where a path starts"},
        {"<svg>\n<path id='dot' d='M 1 1 L 1 1'/></svg>",
         "a.svg:2:2: <path> 'dot': has no length (data-duration-s makes it a tap)"},
        {"<svg>\n<line x2='3zz'/></svg>", "a.svg:2:12: x2 of <line>: unit 'zz' is not known"},
        {"<svg><line x2='nan'/></svg>", "a.svg:1:16: x2 of <line>: 'nan' is not a number"},
        {"<svg><line x2=''/></svg>", "a.svg:1:"},
        {"<svg><line x2='1e300'/></svg>", "a.svg:1:16: x2 of <line>: 1e+300 is beyond 1e+09"},
        {"<svg><line x2='2e6'/></svg>", "a.svg:1:7: <line>: goes to 2e+06 mm"},
        {"<svg><polyline points='0 0 1'/></svg>", "a.svg:1:29: points of <polyline>: an x without a y"},
        {"<svg><polyline points='0 0,1 1,'/></svg>", "a.svg:1:32: points of <polyline>: ends with a comma"},
        {"<svg><rect width='-1' height='2'/></svg>", "a.svg:1:7: width of <rect>: -1 is less than 0"},
        {"<svg><circle r='-1'/></svg>", "a.svg:1:7: r of <circle>: -1 is less than 0"},
        {"<svg><line x2='1' transform='scale(0)'/></svg>", "a.svg:1:7: <line> is flattened by its transform"},
        {"<svg><line x2='1' transform='matrix(1 1 1 1 0 0)'/></svg>", "a.svg:1:7: <line> is flattened"},
        {"<svg viewBox='0 0 1'><line x2='1'/></svg>", "a.svg:1:15: viewBox of <svg>: 3 of 4 numbers"},
        {"<svg viewBox='0 0 0 1'><line x2='1'/></svg>", "a.svg:1:15: viewBox of <svg>: has no size"},
        {"<svg width='0mm' viewBox='0 0 1 1'><line x2='1'/></svg>", "a.svg:1:2: <svg> has no size"},
        {"<svg><line x2='1' data-duration-s='0'/></svg>", "a.svg:1:36: data-duration-s of <line>: 0 ("},
        {"<svg><line x2='1' data-duration-s='1' data-speed-mm-s='1'/></svg>",
         "a.svg:1:7: <line> has data-duration-s and"},
        {"<svg><line x2='1' data-speed-mm-s='fast'/></svg>",
         "a.svg:1:36: data-speed-mm-s of <line>: 'fast' is not"},
        {"<svg><line x2='1000' data-speed-mm-s='0.001'/></svg>", "a.svg:1:7: <line> takes 1e+06 s"},
        {"<svg><line x2='1' data-start-s='-1'/></svg>", "a.svg:1:33: data-start-s of <line>: -1 ("},
        {"<svg><line x2='1' data-intensity='1 2'/></svg>",
         "a.svg:1:36: data-intensity of <line>: '2' behind the number"},
        {"<svg><use/></svg>", "a.svg:1:7: <use> refers to nothing in this file"},
        {"<svg><use href='other.svg#a'/></svg>", "a.svg:1:7: <use> refers to nothing in this file"},
        {"<svg><use href='#a'/></svg>", "a.svg:1:7: <use> refers to #a, which is not in this file"},
        {"<svg><use id='a' href='#a'/></svg>",
         "a.svg:1:7: nested too deep (simplify the drawing, and take out loops of <use>)"},
        {"<svg><g id='a'><use href='#a'/></g></svg>", "a.svg:1:7: nested too deep"},
    };
    for (const sample& s : samples) {
        CAPTURE(s.svg);
        const std::string got = refusal(s.svg);
        CAPTURE(got);
        CHECK(got.find(s.message) == 0);
    }
}

TEST_CASE("deep nesting and doubling references end in an error soon")
{
    CHECK(refusal(fmt::format("<svg>{}<line x2='1'/>{}</svg>", repeated("<g>", 100'000),
                              repeated("</g>", 100'000)))
              .find("nested too deep") != std::string::npos);
    std::string svg = "<svg><defs><line id='u0' x2='1'/>";
    for (int i = 1; i <= 15; ++i)
        svg += fmt::format("<g id='u{}'>{}</g>", i, repeated(fmt::format("<use href='#u{}'/>", i - 1), 10));
    svg += "</defs><use href='#u15'/></svg>";
    CHECK(refusal(svg).find("too many") != std::string::npos);
}

TEST_CASE("entities are not expanded, and nothing outside is read")
{
    const std::string doctype =
        "<!DOCTYPE svg [<!ENTITY d 'M 0 0 H 5'><!ENTITY f SYSTEM 'file:///etc/hostname'>]>";
    CHECK(refusal(doctype + "<svg><path d='&d;'/></svg>").find("'&' where a path starts") !=
          std::string::npos);
    CHECK(refusal(doctype + "<svg><text>&f;</text></svg>").find("no shape") != std::string::npos);
}

} // namespace stroke_svg_errors_test
