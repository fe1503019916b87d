// SPDX-License-Identifier: MIT
// Drawings whose lines give strength and easing by their look.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace stroke_svg_strength_test {

using namespace tactor;

namespace {

std::vector<double> intensities(const std::string& root, const std::string& shapes)
{
    std::vector<double> all;
    for (const stroke& s : parse_strokes_svg("<svg " + root + ">" + shapes + "</svg>", "d.svg"))
        all.push_back(s.motion.intensity(0.0));
    return all;
}

const std::string by_width = "data-intensity-from=\"stroke-width\"";
const std::string by_opacity = "data-intensity-from=\"opacity\"";

} // namespace

TEST_CASE("the widest of the lines with strength by width has intensity 1")
{
    const std::string lines =
        "<path d=\"M 0 0 H 9\" stroke-width=\"4\"/><path d=\"M 0 0 H 9\" style=\"stroke-width:1\"/><g "
        "stroke-width=\"3\"><path d=\"M 0 0 H 9\"/></g><path d=\"M 0 0 H 9\"/>";
    CHECK(intensities("", lines) == std::vector<double>{1.0, 1.0, 1.0, 1.0}); // nobody asked
    CHECK(intensities(by_width, lines) == std::vector<double>{1.0, 0.25, 0.75, 0.25});
    // With what the shape says, and as wide as its transform makes it.
    CHECK(intensities(by_width, "<path d=\"M 0 0 H 9\" stroke-width=\"4\" data-intensity=\"0.5\"/><path "
                                "d=\"M 0 0 H 9\" transform=\"scale(2)\"/>") == std::vector<double>{0.5, 0.5});
    // A shape that does not ask.
    CHECK(intensities(by_width,
                      "<path d=\"M 0 0 H 9\" stroke-width=\"4\"/><path d=\"M 0 0 H 9\" "
                      "stroke-width=\"9\" data-intensity-from=\"none\"/>") == std::vector<double>{1.0, 1.0});
    CHECK(intensities(by_width, "<path d=\"M 0 0 H 9 M 0 5 H 9\" stroke-width=\"0\"/>") ==
          std::vector<double>{1.0, 1.0}); // all alike
}

TEST_CASE("opacity is intensity; groups multiply it and lines inherit it")
{
    CHECK(intensities(by_opacity, "<g opacity=\"0.5\" stroke-opacity=\"50%\"><path d=\"M 0 0 H 9\"/><path "
                                  "d=\"M 0 0 H 9\" opacity=\"0.5\" stroke-opacity=\"1\"/></g><path d=\"M 0 0 "
                                  "H 9\" style=\"opacity: 0.125\"/><path d=\"M 0 0 H 9\" opacity=\"7\"/>") ==
          std::vector<double>{0.25, 0.25, 0.125, 1.0});
}

TEST_CASE("shapes ease")
{
    const auto s =
        parse_strokes_svg("<svg data-easing=\"minimum-jerk\"><path d=\"M 0 0 H 40\" "
                          "data-duration-s=\"2\"/><path d=\"M 0 0 H 40\" data-easing=\"linear\"/></svg>",
                          "d.svg");
    CHECK(s[0].motion.duration_s() == 2.0);
    CHECK(s[0].motion.position(0.5).x_mm == doctest::Approx(40.0 * 0.103515625));
    CHECK(s[1].motion.position(0.25 * s[1].motion.duration_s()).x_mm == doctest::Approx(10.0));
}

TEST_CASE("unreadable looks are reported where they are used")
{
    const auto said = [](const std::string& root, const std::string& shape) {
        return caught_message([&] { intensities(root, "\n" + shape); });
    };
    CHECK(said("", "<path d=\"M 0 0 H 9\" stroke-width=\"calc(1px)\" opacity=\"var(--a)\"/>").empty());
    CHECK(said(by_width, "<path d=\"M 0 0 H 9\" stroke-width=\"calc(1px)\"/>").find("d.svg:2:") == 0);
    CHECK(said(by_width, "<path d=\"M 0 0 H 9\" stroke-width=\"-1\"/>").find("stroke-width of <path>") !=
          std::string::npos);
    CHECK(said(by_opacity, "<path d=\"M 0 0 H 9\" opacity=\"much\"/>").find("d.svg:2:") == 0);
    CHECK(said(by_opacity, "<path d=\"M 0 0 H 9\" opacity=\"1mm\"/>").find("opacity of <path>") !=
          std::string::npos);
    CHECK(said("", "<path d=\"M 0 0 H 9\" data-intensity-from=\"colour\"/>").find("d.svg:2:") == 0);
    CHECK(said("", "<path d=\"M 0 0 H 9\" data-easing=\"fast\"/>").find("linear, in-out or minimum-jerk") !=
          std::string::npos);
}

} // namespace stroke_svg_strength_test
