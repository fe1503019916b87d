// SPDX-License-Identifier: MIT
// Style sheets and CSS transforms, as drawing programs write them.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "has.hpp"

namespace stroke_svg_style_test {

using namespace tactor;

namespace {

std::vector<stroke> strokes(const std::string& content, const std::string& root = "")
{
    return parse_strokes_svg("<svg " + root + ">" + content + "</svg>", "d.svg");
}

std::vector<std::string> names(const std::string& content)
{
    std::vector<std::string> all;
    for (const stroke& s : strokes(content))
        all.push_back(s.name);
    return all;
}

/// Returns the end of a line from (0, 0) to (10, 0).
point end(const std::string& attributes, const std::string& before = "", const std::string& root = "")
{
    return strokes(before + "<line x2='10' " + attributes + "/>", root).front().motion.position(1e9);
}

bool near(point a, point b)
{
    return std::abs(a.x_mm - b.x_mm) < 1e-9 && std::abs(a.y_mm - b.y_mm) < 1e-9;
}

using list = std::vector<std::string>;
const std::string lines = "<path id='a' class='st0' d='M 0 0 H 9'/><path id='b' class='st1 thin' d='M 0 0 H "
                          "8'/><line id='c' class='thin' x2='7'/>";

} // namespace

TEST_CASE("rules of classes, ids and tags hide, the most special one and then the last first")
{
    const auto left = [](const std::string& css) { return names("<style>" + css + "</style>" + lines); };
    CHECK(left("") == list{"a", "b", "c"});
    CHECK(left(".st0{display:none;}") == list{"b", "c"});
    CHECK(left("  .st0 , #c { display : none }") == list{"b"});
    CHECK(left("path{visibility:hidden}") == list{"c"});
    CHECK(left("line,*{visibility:hidden} .thin{visibility:visible}") == list{"b", "c"});
    CHECK(left(".thin{visibility:visible} *{visibility:hidden}") == list{"b", "c"});
    CHECK(left("#b{display:inline} path.thin{display:none}") == list{"a", "b", "c"});
    CHECK(left(".thin{display:none} path.st1{display:inline}") == list{"a", "b"});
    CHECK(left(".st1{display:none} .thin{display:inline}") == list{"a", "b", "c"});
    CHECK(left(".thin{display:inline} .st1{display:none}") == list{"a", "c"});
    CHECK(left("path{display:none!important} #a{display:inline}") == list{"c"});
    CHECK(left("/* .st0{display:none} */ .st1{fill:url(a;b{}.png);DISPLAY:none}") == list{"a", "c"});
    CHECK(left("<![CDATA[.st0{display:none;}\n.st1{stroke-width:2}]]>") == list{"b", "c"});
    CHECK(left(".st0{display:none;display:inline}") == list{"a", "b", "c"});
    CHECK(left(".ST0{display:none} .st{display:none} #A{display:none}") == list{"a", "b", "c"});
}

TEST_CASE("a sheet wins over an attribute and loses to the element's own style")
{
    CHECK(names("<style>.h{display:none} .v{display:inline}</style><line id='a' x2='9' display='none' "
                "class='v'/><line id='b' x2='9' class='h' style='display:inline'/><line id='c' x2='9' "
                "class='h' display='inline'/>") == list{"a", "b"});
    CHECK(names("<line id='a' x2='9'/><g class='h'><line id='b' "
                "x2='9'/></g><defs><style>.h{display:none}</style></defs>") == list{"a"});
    CHECK(
        names("<style>.h{display:none!important}</style><line id='a' x2='9'/><line id='b' x2='9' class='h' "
              "style='display:inline'/><line id='c' x2='9' class='h' style='display:inline !important'/>") ==
        list{"a", "c"});
}

TEST_CASE("transforms of styles and sheets have units and origins")
{
    CHECK(near(end("style='transform:rotate(90deg)'"), {0.0, 10.0}));
    CHECK(near(end("style='transform: translate(5px, 3px) scale(2)'"), {25.0, 3.0}));
    CHECK(near(end("style='transform:translateY(2mm)'"), {10.0, 2.0 * 96.0 / 25.4}));
    CHECK(near(end("style='transform:scaleX(50%) rotate(.25turn)'"), {0.0, 10.0}));
    CHECK(near(end("style='transform:rotate(100grad)'"), {0.0, 10.0}));
    CHECK(near(end("style='transform:translate(50%, 10%)'", "", "viewBox='0 0 40 20'"), {30.0, 2.0}));
    CHECK(near(end("class='r'", "<style>.r{transform:rotate(90deg)}</style>"), {0.0, 10.0}));
    CHECK(near(end("class='r' transform='scale(3)'", "<style>.r{transform:rotate(90deg)}</style>"),
               {0.0, 10.0}));
    CHECK(near(end("style='transform:none' transform='scale(3)'"), {10.0, 0.0}));
    for (const char* origin : {"10px 5px", "25% 25%", "10 5"})
        CHECK(near(end("style='transform:rotate(180deg);transform-origin:" + std::string(origin) + "'", "",
                       "viewBox='0 0 40 20'"),
                   {10.0, 10.0}));
    CHECK(near(end("transform='rotate(180)' transform-origin='center'", "", "viewBox='0 0 40 20'"),
               {30.0, 20.0}));
    CHECK(near(end("transform='rotate(180)' transform-origin='top right'", "", "viewBox='0 0 40 20'"),
               {70.0, 0.0}));
    CHECK(near(end("class='r' transform='rotate(180)'", "<style>.r{transform-origin:10px 0}</style>"),
               {10.0, 0.0}));
    CHECK(near(end("transform-origin='10 5'"), {10.0, 0.0}));
}

TEST_CASE("what is hidden in any spelling does not play, nor what may be")
{
    const std::string other = "<line id='other' x2='8'/>";
    const auto left = [&](const std::string& attributes, const std::string& before = "") {
        return strokes(before + "<line id='a' x2='9' " + attributes + "/>" + other);
    };
    for (const char* hidden : {"style='display: None'", "style='display:/*off*/none'", "display='NONE'",
                               "visibility='/**/hidden'", "style='VISIBILITY:Hidden'",
                               "style='display:none;display:bogus'", "style='display:none!IMPORTANT'"}) {
        CAPTURE(hidden);
        CHECK(left(hidden).size() == 1);
        CHECK(left(hidden).front().warnings.empty());
    }
    for (const char* unknown : {"display:var(--d)", "display:bogus", "visibility:var(--v)", "&amp;st0;"}) {
        CAPTURE(unknown);
        const auto all = left("style='" + std::string(unknown) + "'");
        CHECK(all.size() == 1);
        CHECK(has(all.front().warnings.at(0), "of <line> 'a' is not understood ("));
    }
    for (const char* shown : {"style='display:Inline-Block'", "style='display:inline;display:bogus'",
                              "display='inherit'", "visibility='Visible'", "style='visibility:unset'"}) {
        CAPTURE(shown);
        CHECK(left(shown).size() == 2);
        CHECK(left(shown).front().warnings.empty());
    }
}

TEST_CASE("entities of the document stand for their text in styles")
{
    const std::string doctype =
        "<!DOCTYPE svg [\n <!ENTITY st0 \"fill:red;\">\n <!ENTITY st1 'display:none;'> ]>";
    const auto all =
        parse_strokes_svg(doctype + "<svg><line id='a' x2='9' style='&st0;'/><line id='b' x2='9' "
                                    "style='&st0;&st1;'/><line id='c' x2='9' "
                                    "style='&st2;'/></svg>",
                          "d.svg");
    REQUIRE(all.size() == 1);
    CHECK(all[0].name == "a");
    CHECK(has(all[0].warnings.at(0), "display of <line> 'c' is not understood ('&st2')"));
}

TEST_CASE("a transform that cannot be read is warned of, and does not move its shape")
{
    const auto warned = [](const std::string& attributes) {
        const stroke s = strokes("<line x2='10' " + attributes + "/>").front();
        CHECK(near(s.motion.position(1e9), {10.0, 0.0}));
        return s.warnings.empty() ? "" : s.warnings.front();
    };
    CHECK(warned("style='transform:rotate(3em)'") == "d.svg:1:8: transform of <line> is not followed ('em' "
                                                     "is no unit of an angle): what it hides or moves "
                                                     "plays as if it were not there");
    for (const char* other : {"rotateZ(9deg)", "translate3d(1px,2px,3px)", "translate(calc(1px + 2px))",
                              "matrix(1px)", "var(--t)"})
        CHECK(has(warned("style='transform:" + std::string(other) + "'"),
                  "transform of <line> is not followed"));
    CHECK(near(end("style='TRANSFORM:RotAte(90DEG)'"), {0.0, 10.0}));
    CHECK(near(end("style='transform:rotate(90deg);transform:bogus'"), {0.0, 10.0}));
    CHECK(near(end("style='-webkit-transform:rotate(90deg)'"), {0.0, 10.0}));
    CHECK(
        has(strokes("<line x2='9' transform='scale(2)' transform-origin='1 2 3 4'/>").front().warnings.at(0),
            "transform-origin of <line> is not followed ('1 2 3 4' is not an origin)"));
}

TEST_CASE("unsupported styles are warned of")
{
    const auto warned = [](const std::string& content) {
        std::string all;
        const auto s = strokes(content);
        for (const std::string& w : s.front().warnings)
            all += w + "\n";
        for (std::size_t i = 1; i < s.size(); ++i)
            CHECK(s[i].warnings.empty());
        return all;
    };
    CHECK(warned("<style>.a{fill:red} svg .a{fill:blue} @font-face{font-family:x}</style>" + lines).empty());
    CHECK(warned("<g clip-path='none' mask='none'>" + lines + "</g>").empty());
    CHECK(
        warned(
            "<g clip-path='url(#c)'><line x2='9'/></g><line id='x' x2='8' style='clip-path:circle(3px)'/>") ==
        "d.svg:1:8: clip-path of <g> is not followed, nor of 1 element more: what it hides or moves plays as "
        "if "
        "it were not there\n");
    CHECK(warned("<style>.m{mask:url(#m)}</style><line class='m' x2='9'/>")
              .find("mask of <line> is not followed") != std::string::npos);
    CHECK(warned("<switch><g><line x2='1'/></g><g><line x2='2'/></g></switch>")
              .find("the choice of <switch> is not followed") != std::string::npos);
    CHECK(warned("<switch><foreignObject/><g><line x2='1'/></g></switch>").empty());
    CHECK(warned("<line x2='9' style='transform:rotate(9deg);transform-box:fill-box'/>")
              .find("transform-box: 'fill-box' of <line>") != std::string::npos);
    CHECK(warned("<line x2='9' style='transform-box:fill-box'/>").empty());
    for (const char* property : {"translate", "rotate", "scale", "r", "cx", "d", "filter", "animation"}) {
        CAPTURE(property);
        CHECK(has(warned("<line x2='9' style='" + std::string(property) + ":1px'/>"),
                  " of <line> is not followed"));
        CHECK(has(warned("<style>svg line{" + std::string(property) + ":1px}</style><line x2='9'/>"),
                  "the style rule 'svg line' is not followed"));
    }
    CHECK(has(
        warned("<text>a</text><line x2='9'><animate/></line><text>b</text><image/>"),
        "d.svg:1:8: <text> does not play, nor 1 element more: only shapes do, and text made into paths\n"));
    CHECK(warned("<title>a</title><defs/><x:y/><text display='none'>a</text><line x2='9'/>").empty());
    for (const char* selector :
         {"svg line", "g>line", "line:hover", "line[id]", "line + line", "a|line", ".\\31 "}) {
        CAPTURE(selector);
        CHECK(warned("<style>" + std::string(selector) + "{display:none}</style><line x2='9'/>")
                  .find("d.svg:1:8: the style rule '") == 0);
    }
    CHECK(warned("<style>@MEDIA screen{line{Display:none}}</style><line x2='9'/>")
              .find("the style rule '@MEDIA screen' is not followed") != std::string::npos);
    CHECK(warned("<style media='print'>line{opacity:0}</style><line x2='9'/>").find("'@media print'") !=
          std::string::npos);
}

TEST_CASE("sheets that do not end, or match without end, end")
{
    for (const char* css : {"{", "}", "a{", "a{display", "@", "@media{", "/*", "a{display:none", "a{b:\"",
                            ".{display:none}", "*", "a{}}}b{", ",{display:none}"}) {
        CAPTURE(css);
        CHECK(strokes("<style>" + std::string(css) + "</style><line x2='9'/>").size() == 1);
    }
    std::string many = "<style>";
    for (int i = 0; i < 20000; ++i)
        many += ".a.b" + std::to_string(i) + "{opacity:1}";
    many += "</style>";
    for (int i = 0; i < 20000; ++i)
        many += "<line class='a' x2='9'/>";
    CHECK(has(caught_message([&] { static_cast<void>(strokes(many)); }), "takes too long"));
}

} // namespace stroke_svg_style_test
