// SPDX-License-Identifier: MIT
// Styles of elements, and drawings as drawing programs write them.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <tactor/stroke.hpp>

#include "has.hpp"

namespace stroke_svg_style_test {

using namespace tactor;

namespace {

std::vector<stroke> strokes(const std::string& content)
{
    return parse_strokes_svg("<svg>" + content + "</svg>", "d.svg");
}

using list = std::vector<std::string>;

list names(const std::vector<stroke>& strokes)
{
    list all;
    for (const stroke& s : strokes)
        all.push_back(s.name);
    return all;
}

std::string warned(const std::string& content)
{
    std::string all;
    const auto s = strokes(content);
    for (const std::string& w : s.front().warnings)
        all += w + "\n";
    for (std::size_t i = 1; i < s.size(); ++i)
        CHECK(s[i].warnings.empty());
    return all;
}

/// Returns the end of a line from (0, 0) to (10, 0).
point end(const std::string& attributes)
{
    return strokes("<line x2='10' " + attributes + "/>").front().motion.position(1e9);
}

bool near(point a, point b)
{
    return std::abs(a.x_mm - b.x_mm) < 1e-9 && std::abs(a.y_mm - b.y_mm) < 1e-9;
}

} // namespace

TEST_CASE("a drawing as Illustrator exports it plays without a warning")
{
    const std::string before =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg id=\"Layer_1\" "
        "xmlns=\"http://www.w3.org/2000/svg\" "
        "viewBox=\"0 0 200 200\">\n<defs><style>.cls-1{fill:none;stroke:#000;stroke-miterlimit:10;}";
    const std::string behind =
        "</style></defs>\n<g fill=\"none\"><path id=\"a\" class=\"cls-1\" d=\"M 0 0 H 9\"/></g>"
        "<switch><foreignObject/><g><line id=\"b\" class=\"cls-2\" x1=\"9\" x2=\"7\"/></g></switch></svg>";
    const auto paint = parse_strokes_svg(before + ".cls-2{opacity:.5}" + behind, "d.svg");
    CHECK(names(paint) == list{"a", "b"});
    CHECK(paint.front().warnings.empty());
    const auto hidden = parse_strokes_svg(
        before + "\n.cls-2,\n.cls-3{opacity:1; DISPLAY : none!important}" + behind, "d.svg");
    CHECK(names(hidden) == list{"a"});
    CHECK(hidden.front().warnings.empty());
    // Other rules are not followed.
    const auto ruled = parse_strokes_svg(before + "g .cls-2, .cls-1{display:none}" + behind, "d.svg");
    CHECK(names(ruled) == list{"a", "b"});
    CHECK(ruled.front().warnings ==
          list{"d.svg:3:8: display in <style> is not followed: what it hides or moves plays as if it were "
               "not there (export presentation attributes)"});
}

TEST_CASE("a drawing as Inkscape saves it plays what its layers show")
{
    const auto all = parse_strokes_svg(
        "<svg width=\"50mm\" height=\"50mm\" viewBox=\"0 0 50 50\" xmlns:inkscape=\"i\" xmlns:sodipodi=\"s\">"
        "<sodipodi:namedview id=\"base\"/><defs id=\"defs1\"/>"
        "<g inkscape:groupmode=\"layer\" id=\"layer1\" style=\"display:none\"><path id=\"a\" d=\"M 0 0 H "
        "9\"/>"
        "</g><g inkscape:groupmode=\"layer\" id=\"layer2\" style=\"display:inline\" "
        "transform=\"translate(5,6)\"><path id=\"b\" sodipodi:nodetypes=\"cc\" d=\"M 0 0 H 10\" "
        "style=\"fill:none;stroke:#000000;stroke-width:0.26;font-family:'x';stroke-opacity:1\"/></g></svg>",
        "d.svg");
    CHECK(names(all) == list{"b"});
    CHECK(all.front().warnings.empty());
    CHECK(near(all.front().motion.position(1e9), {15.0, 6.0}));
}

TEST_CASE("an element's own style wins over its attributes")
{
    CHECK(names(strokes("<line id='a' x2='9' display='none' style='display:inline'/><line id='b' x2='8' "
                        "display='inline' style='fill:red; DISPLAY : None;'/><g visibility='hidden'><line "
                        "id='c' x2='7' style='visibility:visible'/></g>")) == list{"a", "c"});
    CHECK(near(end("style='transform:none' transform='scale(3)'"), {10.0, 0.0}));
    CHECK(near(end("style='TRANSFORM:RotAte(90DEG)'"), {0.0, 10.0}));
    CHECK(near(end("style='transform: translate(5px, 3px) scale(2)'"), {25.0, 3.0}));
}

TEST_CASE("an element that may be hidden does not play")
{
    const auto left = [&](const std::string& attributes) {
        return strokes("<line id='a' x2='9' " + attributes + "/><line x2='8'/>");
    };
    for (const char* hidden : {"style='display: None'", "display='NONE'", "style='VISIBILITY:Hidden'",
                               "visibility='collapse'", "style='display:none!IMPORTANT'"}) {
        CAPTURE(hidden);
        CHECK(left(hidden).size() == 1);
        CHECK(left(hidden).front().warnings.empty());
    }
    for (const char* unknown : {"display:var(--d)", "display:/*off*/none", "display:none;display:bogus",
                                "visibility:var(--v)", "fill:red;&amp;st0;"}) {
        CAPTURE(unknown);
        const auto all = left("style='" + std::string(unknown) + "'");
        CHECK(all.size() == 1);
        CHECK(has(all.front().warnings.at(0), "of <line> 'a' is not understood ("));
        CHECK(has(all.front().warnings.at(0), "): that is taken as hidden"));
    }
    for (const char* shown : {"style='display:Inline-Block'", "display='inherit'", "visibility='Visible'"}) {
        CAPTURE(shown);
        CHECK(left(shown).size() == 2);
        CHECK(left(shown).front().warnings.empty());
    }
}

TEST_CASE("a transform that cannot be read is warned of, and does not move its shape")
{
    const auto unmoved = [](const std::string& attributes) {
        const stroke s = strokes("<line x2='10' " + attributes + "/>").front();
        CHECK(near(s.motion.position(1e9), {10.0, 0.0}));
        return s.warnings.empty() ? "" : s.warnings.front();
    };
    CHECK(unmoved("style='transform:rotate(3em)'") ==
          "d.svg:1:7: transform of <line> is not followed ('em' is not a number): what it hides or moves "
          "plays as if it were not there");
    for (const char* other : {"rotate(9turn)", "rotateZ(9deg)", "translate(2mm)", "scale(1,2,3)",
                              "matrix(1px)", "var(--t)", "rotate", "inherit", "translate(calc(1px + 2px))"})
        CHECK(has(unmoved("style='transform:" + std::string(other) + "'"),
                  "transform of <line> is not followed ("));
    CHECK(has(unmoved("style='-webkit-transform:rotate(9deg)'"),
              "-webkit-transform of <line> is not followed"));
    CHECK(unmoved("transform-origin='10 5'").empty());
    for (const char* about : {"transform-origin", "transform-box"})
        CHECK(has(warned("<line x2='9' style='transform:rotate(9deg);" + std::string(about) + ":center'/>"),
                  std::string(about) + " of <line> is not followed"));
}

TEST_CASE("other properties that hide or move are warned of, once for each")
{
    CHECK(warned("<g clip-path='none' mask='none'><line x2='9'/></g>").empty());
    CHECK(
        warned(
            "<g clip-path='url(#c)'><line x2='9'/></g><line id='x' x2='8' style='clip-path:circle(3px)'/>") ==
        "d.svg:1:7: clip-path of <g> is not followed, nor of 1 element more: what it hides or moves plays as "
        "if it were not there\n");
    for (const char* property : {"translate", "rotate", "scale", "r", "cx", "d", "filter", "animation"}) {
        CAPTURE(property);
        CHECK(has(warned("<line x2='9' style='" + std::string(property) + ":1px'/>"),
                  std::string(property) + " of <line> is not followed"));
        CHECK(has(warned("<style>svg line{" + std::string(property) + ":1px}</style><line x2='9'/>"),
                  std::string(property) + " in <style> is not followed"));
    }
    CHECK(has(
        warned("<text>a</text><line x2='9'><animate/></line><text>b</text><image/>"),
        "d.svg:1:7: <text> does not play, nor 1 element more: only shapes do, and text made into paths\n"));
    CHECK(warned("<title>a</title><defs/><x:y/><text display='none'>a</text><line x2='9'/>").empty());
}

TEST_CASE("of a switch its first child plays")
{
    CHECK(names(strokes("<switch><text/><g><line id='a' x2='1'/></g><line id='b' x2='2'/></switch>")) ==
          list{"a"});
}

TEST_CASE("rules and styles that do not end, end")
{
    for (const char* css : {"{", "}", "a{", "a{display", "@", "@media{", "/*", "a{display:none", "a{b:\"",
                            ".{display:none}", "*", "a{}}}b{", ",{display:none}", ":", ";;", "!", "&amp;"}) {
        CAPTURE(css);
        CHECK(strokes("<style>" + std::string(css) + "</style><line x2='9'/>").size() == 1);
        CHECK(strokes("<line x2='8' style='" + std::string(css) + "'/><line x2='9'/>").size() >= 1);
    }
}

} // namespace stroke_svg_style_test
