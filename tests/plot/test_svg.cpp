// SPDX-License-Identifier: MIT
#include <clocale>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include "plot/paint/output.hpp"

namespace svg_test {

using namespace tactor::plot;

namespace {

canvas empty()
{
    canvas c;
    c.width = 85.0 * pt_per_mm;
    c.height = 72.0;
    c.title = "a <title> & more";
    c.description = "what it \"shows\"";
    return c;
}

bool has(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("an SVG has its size in mm, its title and its description")
{
    const std::string s = to_svg(empty());
    CHECK(has(s, "width=\"85mm\" height=\"25.4mm\" viewBox=\"0 0 240.945 72\""));
    CHECK(has(s, "<title id=\"title\">a &lt;title&gt; &amp; more</title>"));
    CHECK(has(s, "<desc id=\"desc\">what it &quot;shows&quot;</desc>"));
    CHECK(s.ends_with("</svg>\n"));
}

TEST_CASE("elements carry their ids, classes, titles and data")
{
    canvas c = empty();
    {
        const group g(c, {.id = "burst-3", .kind = "burst", .title = "3 < 4", .data = {{"mm", "1.5"}}});
        c.circle({1.0, 2.5}, 3.25, {.fill = with_alpha(blue, 0.5)}, {.kind = "dot"});
        c.line({0.0, 0.0}, {1.0, 1.0}, {.stroke = ink, .width = 0.25, .dash = 2.0});
    }
    const std::string s = to_svg(c);
    CHECK(has(s,
              "<g id=\"burst-3\" class=\"burst\" data-mm=\"1.5\"><title>3 &lt; 4</title>\n<circle cx=\"1\" "
              "cy=\"2.5\" r=\"3.25\" fill=\"#0072b2\" fill-opacity=\"0.5\" class=\"dot\"/>\n<line x1=\"0\""));
    CHECK(has(s, "stroke-dasharray=\"2\"/>\n</g>\n</svg>"));
}

TEST_CASE("text is text, with any content")
{
    canvas c = empty();
    c.text({5.0, 6.0}, "a&b\x01\xFF", {.anchor = align::end, .halo = true, .upwards = true},
           {.kind = "label"});
    const std::string s = to_svg(c);
    CHECK(has(s, "a&amp;b\xEF\xBF\xBD\xEF\xBF\xBD</text>"));
    CHECK(has(s, "text-anchor=\"end\""));
    CHECK(has(s, "transform=\"rotate(-90 5 6)\""));
    CHECK(has(s, "paint-order=\"stroke\""));
}

TEST_CASE("numbers are numbers in every locale, and never nan")
{
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* l : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
        std::setlocale(LC_ALL, l); // where it is not installed, the test checks less
        canvas c = empty();
        c.circle({0.5, -0.0001}, std::numeric_limits<double>::quiet_NaN(), {.fill = black});
        CHECK(has(to_svg(c), "<circle cx=\"0.5\" cy=\"0\" r=\"0\" fill=\"#000000\"/>"));
    }
    std::setlocale(LC_ALL, before.c_str());
}

} // namespace svg_test
