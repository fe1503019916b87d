// SPDX-License-Identifier: MIT
#include <clocale>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "plot/paint/output.hpp"

namespace output_test {

using namespace tactor::plot;
using namespace tactor;

namespace {

canvas page()
{
    canvas c;
    c.width = 144.0;
    c.height = 72.0;
    c.title = "page";
    c.rect({10.0, 10.0, 20.0, 20.0}, {.fill = blue, .stroke = ink});
    c.text({10.0, 50.0}, "text \xFF", {.halo = true});
    return c;
}

std::uint32_t big_endian(const std::string& s, std::size_t at)
{
    std::uint32_t v = 0;
    for (std::size_t i = at; i < at + 4; ++i)
        v = (v << 8U) | static_cast<unsigned char>(s[i]);
    return v;
}

canvas empty()
{
    canvas c;
    c.width = 85.0 * pt_per_mm;
    c.height = 72.0;
    c.title = "a <title> & more";
    c.description = "what it \"shows\"";
    return c;
}

} // namespace

TEST_CASE("a PNG has the pixels of its size and resolution, and their density")
{
    const std::string png = to_png(page(), 300);
    CHECK(png.starts_with("\x89PNG\r\n\x1a\n"));
    CHECK(big_endian(png, 16) == 600);
    CHECK(big_endian(png, 20) == 300);
    REQUIRE(png.substr(37, 4) == "pHYs");
    CHECK(big_endian(png, 41) == 11811);       // pixels to the metre
    CHECK(big_endian(png, 50) == 0x78A53F76U); // CRC of this chunk at 300 dpi, as other programs write it
}

TEST_CASE("more pixels than an image may have are refused")
{
    canvas c = page();
    c.height = 40000.0;
    CHECK_THROWS_AS(to_png(c, 300), error);
    c.height = c.width = 10000.0;
    CHECK_THROWS_AS(to_png(c, 2400), error);
}

TEST_CASE("a PDF is one, and the same each time")
{
    const std::string pdf = to_pdf(page());
    CHECK(pdf.starts_with("%PDF-1."));
    CHECK(pdf.find("%%EOF") != std::string::npos);
    CHECK(to_pdf(page()) == pdf);
}

TEST_CASE("rsvg-convert gets no date, and an error has its package or its own message")
{
    const folder programs;
    const std::string before = std::getenv("PATH");
    const auto install = [&](const char* script) {
        std::filesystem::permissions(programs.write("rsvg-convert", script),
                                     std::filesystem::perms::owner_all);
    };
    ::setenv("PATH", programs.path().c_str(), 1);
    constexpr const char* missing = "another kind: picture: rsvg-convert, which makes PNG and PDF, is "
                                    "missing (install librsvg2-bin, or write SVG)";
    CHECK(caught_message([] { to_png(page(), 300); }) == missing);
    CHECK(caught_message([] { to_pdf(page()); }) == missing);
    install("#!/bin/sh\necho 'no font' >&2\nexit 1\n");
    CHECK(caught_message([] { to_pdf(page()); }) == "another kind: rsvg-convert: no font (write SVG)");
    install("#!/bin/sh\necho \"$SOURCE_DATE_EPOCH $*\"\n");
    ::setenv("SOURCE_DATE_EPOCH", "1234567890", 1);
    CHECK(to_pdf(page()) == "0 --unlimited --format=pdf\n");
    ::unsetenv("SOURCE_DATE_EPOCH");
    ::setenv("PATH", before.c_str(), 1);
}

TEST_CASE("the format follows the name, in upper or lower case")
{
    CHECK(find_format("a.svg") == file_format::svg);
    CHECK(find_format("b/c.PNG") == file_format::png);
    CHECK(find_format("a.b.Pdf") == file_format::pdf);
    for (const char* name : {"a", "a.jpg", "svg", ".svg", "a.svg/", "a.svg.gz", ""})
        CHECK_THROWS_AS(find_format(name), error);
}

TEST_CASE("an SVG has its size in mm, its title and its description")
{
    const std::string s = to_svg(empty());
    has(s, "width=\"85mm\" height=\"25.4mm\" viewBox=\"0 0 240.945 72\"");
    has(s, "<title id=\"title\">a &lt;title&gt; &amp; more</title>");
    has(s, "<desc id=\"desc\">what it &quot;shows&quot;</desc>");
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
    has(s, "<g id=\"burst-3\" class=\"burst\" data-mm=\"1.5\"><title>3 &lt; 4</title>\n<circle cx=\"1\" "
           "cy=\"2.5\" r=\"3.25\" fill=\"#0072b2\" fill-opacity=\"0.5\" class=\"dot\"/>\n<line x1=\"0\"");
    has(s, "stroke-dasharray=\"2\"/>\n</g>\n</svg>");
}

TEST_CASE("text is text, with any content")
{
    canvas c = empty();
    c.text({5.0, 6.0}, "a&b\x01\xFF", {.anchor = align::end, .halo = true, .upwards = true},
           {.kind = "label"});
    const std::string s = to_svg(c);
    has(s, "a&amp;b\xEF\xBF\xBD\xEF\xBF\xBD</text>");
    has(s, "text-anchor=\"end\"");
    has(s, "transform=\"rotate(-90 5 6)\"");
    has(s, "paint-order=\"stroke\"");
}

TEST_CASE("numbers are numbers in every locale, and never nan")
{
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* l : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
        std::setlocale(LC_ALL, l); // where it is not installed, the test checks less
        canvas c = empty();
        c.circle({0.5, -0.0001}, std::numeric_limits<double>::quiet_NaN(), {.fill = black});
        has(to_svg(c), "<circle cx=\"0.5\" cy=\"0\" r=\"0\" fill=\"#000000\"/>");
    }
    std::setlocale(LC_ALL, before.c_str());
}

} // namespace output_test
