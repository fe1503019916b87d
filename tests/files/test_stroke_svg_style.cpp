// SPDX-License-Identifier: MIT
// Styles of elements, drawings as drawing programs write them, and faults.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "rounds.hpp"

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

std::string refusal(const std::string& svg)
{
    return caught_message([&] { return parse_strokes_svg(svg, "a.svg"); });
}

std::string repeated(const std::string& what, int times)
{
    std::string all;
    for (int i = 0; i < times; ++i)
        all += what;
    return all;
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
    for (const char* hides : {"visibility:hidden", "visibility:collapse"})
        CHECK(names(parse_strokes_svg(before + ".cls-2{" + hides + "}" + behind, "d.svg")) == list{"a"});
    // Other rules that hide are refused, and those that move are warned of.
    CHECK(refusal(before + "g .cls-2, .cls-1{display:none}" + behind) ==
          "a.svg:3:8: a rule hides the elements of 'g .cls-2, .cls-1', a selector that is not supported "
          "(delete the hidden elements, or export presentation attributes)");
    for (const auto& [name, value] :
         {std::pair<std::string, std::string>{"display", "inline"}, {"transform", "scale(2)"}}) {
        const auto ruled =
            parse_strokes_svg(before + "g .cls-2{" + name + ":" + value + "}" + behind, "d.svg");
        CHECK(names(ruled) == list{"a", "b"});
        CHECK(ruled.front().warnings ==
              list{"d.svg:3:8: " + name +
                   " in <style> is not supported: a shape that it hides or moves plays as if it were not "
                   "there (export presentation attributes)"});
    }
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

TEST_CASE("a hidden element does not play, and one that may be hidden is warned of")
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
        CHECK(all.size() == 2);
        CHECK(has(all.front().warnings.at(0), "of <line> 'a' is not supported ("));
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
          "d.svg:1:7: transform of <line> is not supported ('em' is not a number): a shape that it hides or "
          "moves plays as if it were not there");
    for (const char* other : {"rotate(9turn)", "rotateZ(9deg)", "translate(2mm)", "scale(1,2,3)",
                              "matrix(1px)", "var(--t)", "rotate", "inherit", "translate(calc(1px + 2px))"})
        CHECK(has(unmoved("style='transform:" + std::string(other) + "'"),
                  "transform of <line> is not supported ("));
    CHECK(has(unmoved("style='-webkit-transform:rotate(9deg)'"),
              "-webkit-transform of <line> is not supported"));
    CHECK(unmoved("transform-origin='10 5'").empty());
    for (const char* about : {"transform-origin", "transform-box"})
        CHECK(has(warned("<line x2='9' style='transform:rotate(9deg);" + std::string(about) + ":center'/>"),
                  std::string(about) + " of <line> is not supported"));
}

TEST_CASE("other properties that hide or move are warned of, once for each")
{
    CHECK(warned("<g clip-path='none' mask='none'><line x2='9'/></g>").empty());
    CHECK(
        warned(
            "<g clip-path='url(#c)'><line x2='9'/></g><line id='x' x2='8' style='clip-path:circle(3px)'/>") ==
        "d.svg:1:7: clip-path of <g> is not supported (and 1 element more): a shape that it hides or moves "
        "plays as if it were not there\n");
    for (const char* property : {"translate", "rotate", "scale", "r", "cx", "d", "filter", "animation"}) {
        CAPTURE(property);
        CHECK(has(warned("<line x2='9' style='" + std::string(property) + ":1px'/>"),
                  std::string(property) + " of <line> is not supported"));
        CHECK(has(warned("<style>svg line{" + std::string(property) + ":1px}</style><line x2='9'/>"),
                  std::string(property) + " in <style> is not supported"));
    }
    CHECK(has(warned("<text>a</text><line x2='9'><animate/></line><text>b</text><image/>"),
              "d.svg:1:7: <text> does not play (and 1 element more): only shapes do, and text converted to "
              "paths\n"));
    CHECK(warned("<title>a</title><defs/><x:y/><text display='none'>a</text><line x2='9'/>").empty());
}

TEST_CASE("of a switch its first child plays")
{
    CHECK(names(strokes("<switch><text/><g><line id='a' x2='1'/></g><line id='b' x2='2'/></switch>")) ==
          list{"a"});
}

TEST_CASE("a switch follows the conditions of its children")
{
    const std::string other = "<line id='b' x2='2'/>";
    const auto of = [&](const std::string& conditions) {
        return names(strokes("<switch><line id='a' x2='1' " + conditions + "/>" + other + "</switch>"));
    };
    CHECK(of("") == list{"a"});
    CHECK(of("requiredExtensions='http://example.org/x'") == list{"b"});
    CHECK(of("systemLanguage='de'") == list{"b"});
    CHECK(names(strokes("<switch><line id='a' x2='1' systemLanguage='de'/>"
                        "<line id='b' x2='2' systemLanguage='en'/></switch>")) == list{"a"});
    CHECK(warned("<switch><line x2='1' systemLanguage='de'/>" + other + "</switch>") ==
          "d.svg:1:15: systemLanguage of <line> is not supported: a <switch> plays its first shape without "
          "one\n");
    // Outside a switch as well, what needs an extension is not drawn.
    CHECK(names(strokes("<line x2='1' requiredExtensions='x'/>" + other)) == list{"b"});
}

TEST_CASE("a shape that a browser shows nothing of plays, and is warned of")
{
    for (const char* clear :
         {"stroke='none'", "stroke='#00000000'", "stroke='#0000'", "stroke='rgba(0, 0, 0, 0)'",
          "stroke='rgb(0 0 0 / 0%)'", "stroke='#000' stroke-opacity='0'", "stroke='#000' stroke-width='0'",
          "style='stroke:#000;stroke-width:0px'", "stroke='#000' opacity='0'"}) {
        CAPTURE(clear);
        CHECK(warned(std::string("<line x2='1' fill='none' ") + clear + "/>") ==
              "d.svg:1:7: <line> has neither fill nor stroke, or no opacity: it still plays\n");
    }
    for (const char* shown :
         {"stroke='#000'", "stroke='#00000080'", "stroke='#0008'", "stroke='rgba(0, 0, 0, 0.5)'",
          "stroke='rgb(0, 0, 0)'", "stroke='url(#x)'", "stroke='#000' stroke-opacity='0.1'",
          "stroke='#000' fill-opacity='0'", "stroke='#000' stroke-width='0.1'"}) {
        CAPTURE(shown);
        CHECK(warned(std::string("<line x2='1' fill='none' ") + shown + "/>").empty());
    }
    // Inherited, and set anew inside.
    CHECK(warned("<g stroke='#000' stroke-opacity='0'><line x2='1' fill='none'/></g>") != "");
    CHECK(warned("<g stroke='#000' stroke-opacity='0'><line x2='1' fill='none' stroke-opacity='1'/></g>")
              .empty());
}

TEST_CASE("rules of another file are not read, which is warned of")
{
    const std::string end = " names another file, which is not read: a shape that its rules hide or move "
                            "plays as if they were not there (put the rules into the drawing)\n";
    const std::string line = "<line class='guide' x2='1' stroke='#000'/>";
    CHECK(warned("<style>@import \"hide.css\";</style>" + line) == "d.svg:1:7: @import" + end);
    CHECK(warned("<style>@IMPORT url(hide.css); .x { stroke: red }</style>" + line) ==
          "d.svg:1:7: @import" + end);
    // A rule behind it is still understood.
    CHECK(names(strokes("<style>@import 'x.css'; .guide {display:none}</style>" + line +
                        "<line id='b' x2='2'/>")) == list{"b"});
    const auto s = parse_strokes_svg(
        "<?xml-stylesheet type='text/css' href='hide.css'?><svg>" + line + "</svg>", "d.svg");
    REQUIRE(s.front().warnings.size() == 1);
    CHECK(s.front().warnings.front() + "\n" == "d.svg:1:3: <?xml-stylesheet?>" + end);
}

TEST_CASE("rules and styles that do not end, end")
{
    for (const char* css : {"{", "}", "a{", "a{display", "@", "@media{", "/*", "a{fill:none", "a{b:\"",
                            ".{fill:none}", "*", "a{}}}b{", ",{fill:none}", ":", ";;", "!", "&amp;"}) {
        CAPTURE(css);
        CHECK(strokes("<style>" + std::string(css) + "</style><line x2='9'/>").size() == 1);
        CHECK(strokes("<line x2='8' style='" + std::string(css) + "'/><line x2='9'/>").size() >= 1);
    }
    for (const char* css : {"a{display:none", ".{display:none}", ",{display:none}"})
        CHECK(refusal("<svg><style>" + std::string(css) + "</style><line x2='9'/></svg>").find("hides") !=
              std::string::npos);
}

TEST_CASE("faults of an SVG file are named by line and column")
{
    const refused_text samples[] = {
        {"", "a.svg: it is empty (use TOML, CSV, SVG, TACT, HAPTIC or AHAP"},
        {"t_s,x_mm,y_mm\n0,1,2\n", "a.svg:1:1: it is a table (CSV)"},
        {"<svg>", "a.svg:1:5: Start-end tags mismatch"},
        {"<svg>\n <g></svg>", "a.svg:2:"},
        {"<html/>", "a.svg:1:2: <html> is not <svg>"},
        {"<svg/>", "a.svg: it has no shape"},
        {"<svg><text>a</text></svg>", "a.svg: it has no shape"},
        {"<svg>\n<line id='l' x2='3' visibility='hidden'/></svg>",
         "a.svg:2:2: <line> 'l' is hidden, and nothing else draws (remove display and visibility)"},
        {"<svg><g id='layer' display='none'><line x2='3'/></g></svg>",
         "a.svg:1:7: <g> 'layer' is hidden, and "},
        {"<svg style='display:none'><line x2='3'/></svg>", "a.svg:1:2: <svg> is hidden, and "},
        {"<svg>\n<path id='p' d='M 0 0\n L 1 x'/></svg>",
         "a.svg:3:6: d of <path> 'p': a number of L is missing before 'x'"},
        {"<svg>\n<path d='L 1 1'/></svg>", "a.svg:2:10: d of <path>: 'L' cannot start a path"},
        {"<svg>\n<path id='dot' d='M 1 1 L 1 1'/></svg>",
         "a.svg:2:2: <path> 'dot': it has no length (add data-duration-s to make it a tap)"},
        {"<svg>\n<line x2='3zz'/></svg>", "a.svg:2:12: x2 of <line>: unit 'zz' is unknown"},
        {"<svg><line x2='nan'/></svg>", "a.svg:1:16: x2 of <line>: 'nan' is not a number"},
        {"<svg><line x2=''/></svg>", "a.svg:1:"},
        {"<svg><line x2='1e300'/></svg>", "a.svg:1:16: x2 of <line>: 1e+300 is beyond 1e+09"},
        {"<svg><line x2='2e6'/></svg>", "a.svg:1:7: <line>: it goes to 2e+06 mm"},
        {"<svg><polyline points='0 0 1'/></svg>", "a.svg:1:29: points of <polyline>: an x has no y"},
        {"<svg><polyline points='0 0,1 1,'/></svg>",
         "a.svg:1:32: points of <polyline>: it ends with a comma"},
        {"<svg><rect width='-1' height='2'/></svg>", "a.svg:1:7: width of <rect>: -1 is less than 0"},
        {"<svg><circle r='-1'/></svg>", "a.svg:1:7: r of <circle>: -1 is less than 0"},
        {"<svg><line x2='1' transform='scale(0)'/></svg>", "a.svg:1:7: <line> is flattened by its transform"},
        {"<svg><line x2='1' transform='matrix(1 1 1 1 0 0)'/></svg>", "a.svg:1:7: <line> is flattened"},
        {"<svg viewBox='0 0 1'><line x2='1'/></svg>", "a.svg:1:15: viewBox of <svg>: it has 3 of 4 numbers"},
        {"<svg viewBox='0 0 0 1'><line x2='1'/></svg>", "a.svg:1:15: viewBox of <svg>: it has no size"},
        {"<svg width='0mm' viewBox='0 0 1 1'><line x2='1'/></svg>", "a.svg:1:2: <svg> has no size"},
        {"<svg><line x2='1' data-duration-s='0'/></svg>", "a.svg:1:36: data-duration-s of <line>: 0 ("},
        {"<svg><line x2='1' data-duration-s='1' data-speed-mm-s='1'/></svg>",
         "a.svg:1:7: <line> has both data-duration-s and"},
        {"<svg><line x2='1' data-speed-mm-s='fast'/></svg>",
         "a.svg:1:36: data-speed-mm-s of <line>: 'fast' is not"},
        {"<svg><line x2='1000' data-speed-mm-s='0.001'/></svg>", "a.svg:1:7: <line> lasts 1e+06 s"},
        {"<svg><line x2='1' data-start-s='-1'/></svg>", "a.svg:1:33: data-start-s of <line>: -1 ("},
        {"<svg><line x2='1' data-intensity='1 2'/></svg>",
         "a.svg:1:36: data-intensity of <line>: '2' follows the number"},
        {"<svg><use/></svg>", "a.svg:1:7: <use> refers to nothing in this file"},
        {"<svg><use href='other.svg#a'/></svg>", "a.svg:1:7: <use> refers to nothing in this file"},
        {"<svg><use href='#a'/></svg>", "a.svg:1:7: <use> refers to #a, which is not in this file"},
        {"<svg><use id='a' href='#a'/></svg>",
         "a.svg:1:7: nested too deep (simplify the drawing, and remove loops of <use>)"},
        {"<svg><g id='a'><use href='#a'/></g></svg>", "a.svg:1:7: nested too deep"},
    };
    check_messages(samples, refusal);
}

TEST_CASE("deep nesting and doubling references end in an error soon")
{
    CHECK(refusal(fmt::format("<svg>{}<line x2='1'/>{}</svg>", repeated("<g>", 100'000),
                              repeated("</g>", 100'000)))
              .find("nested too deep") != std::string::npos);
    // 10^15 lines, or 101^3 empty groups: each is one too many after the same number of elements.
    const int levels = test::whole() ? 15 : 3;
    const int each = test::whole() ? 10 : 101;
    std::string svg = fmt::format("<svg><defs>{}", test::whole() ? "<line id='u0' x2='1'/>" : "<g id='u0'/>");
    for (int i = 1; i <= levels; ++i)
        svg += fmt::format("<g id='u{}'>{}</g>", i, repeated(fmt::format("<use href='#u{}'/>", i - 1), each));
    svg += fmt::format("</defs><use href='#u{}'/></svg>", levels);
    CHECK(refusal(svg).find("too many") != std::string::npos);
}

TEST_CASE("entities are not expanded, and nothing outside is read")
{
    const std::string doctype =
        "<!DOCTYPE svg [<!ENTITY d 'M 0 0 H 5'><!ENTITY f SYSTEM 'file:///etc/hostname'>]>";
    CHECK(refusal(doctype + "<svg><path d='&d;'/></svg>").find("'&' cannot start a path") !=
          std::string::npos);
    CHECK(refusal(doctype + "<svg><text>&f;</text></svg>").find("no shape") != std::string::npos);
}

} // namespace stroke_svg_style_test
