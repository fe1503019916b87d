// SPDX-License-Identifier: MIT
#include <cstdint>
#include <string>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "plot/paint/output.hpp"

namespace output_test {

using namespace tactor;
using namespace tactor::plot;

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

TEST_CASE("a PDF is one, without the time of day")
{
    const std::string pdf = to_pdf(page());
    CHECK(pdf.starts_with("%PDF-1."));
    CHECK(pdf.find("%%EOF") != std::string::npos);
    CHECK(pdf.find("/CreationDate") == std::string::npos);
    CHECK(to_pdf(page()) == pdf);
}

TEST_CASE("the format follows the name, in upper or lower case")
{
    CHECK(find_format("a.svg") == file_format::svg);
    CHECK(find_format("b/c.PNG") == file_format::png);
    CHECK(find_format("a.b.Pdf") == file_format::pdf);
    for (const char* name : {"a", "a.jpg", "svg", ".svg", "a.svg/", "a.svg.gz", ""})
        CHECK_THROWS_AS(find_format(name), error);
}

} // namespace output_test
