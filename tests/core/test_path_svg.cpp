// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <clocale>
#include <random>
#include <string>

#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "path_samples.hpp"
#include "rounds.hpp"

namespace path_svg_test {

using tactor::path;

namespace {

std::string refusal(const std::string& data)
{
    return caught_message([&] { static_cast<void>(path::from_svg(data)); });
}

// A locale in which a number has a decimal comma, for as long as it lives.
class comma_locale {
public:
    comma_locale() : before_(std::setlocale(LC_ALL, nullptr))
    {
        for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) {
            if (std::setlocale(LC_ALL, name) != nullptr) {
                found_ = true;
                return;
            }
        }
    }
    ~comma_locale() { std::setlocale(LC_ALL, before_.c_str()); }
    comma_locale(const comma_locale&) = delete;
    comma_locale& operator=(const comma_locale&) = delete;

    bool found() const { return found_; }

private:
    std::string before_;
    bool found_ = false;
};

} // namespace

TEST_CASE("bad path data is refused at the first bad column")
{
    struct sample {
        std::string data;
        std::string message;
    };
    const sample samples[] = {
        {"", "path data: column 1: is empty (it starts with M x y)"},
        {" \t\n", "path data: column 4: is empty"},
        {"L 1 1", "path data: column 1: 'L' where a path starts (it starts with M x y)"},
        {"M 0 0 L 1 1 garbage", "path data: column 13: 'g' is not a path command"},
        {"M 0 0 L 1", "path data: column 10: the end where L wants a number (L takes 2 numbers)"},
        {"M 0 0 L 1 1 2", "path data: column 14: the end where L wants a number"},
        {"M 0 0 L 1 x", "path data: column 11: 'x' where L wants a number"},
        {"M 0 0,L 1 1", "path data: column 7: 'L' where a number is wanted (a number follows each comma)"},
        {"M 0 0 L 1,,1", "path data: column 11: ',' where L wants a number"},
        {"M 0 0 L 1 1,", "path data: column 13: the end where a number is wanted"},
        {"M nan 0 L 1 1", "path data: column 3: 'n' where M wants a number"},
        {"M 0 0 L inf 1", "path data: column 9: 'i' where L wants a number"},
        {"M 0 0 L 0x10 1", "path data: column 10: 'x' where L wants a number"},
        {"M 0 0 L 1e400 1", "path data: column 9: inf is beyond 1e+06 (is it the right unit?)"},
        {"M 0 0 L 5 -1000001", "path data: column 11: -1e+06 is beyond 1e+06"},
        {"M 0 0 A 1 1 0 2 0 5 5", "path data: column 15: '2' where A wants a flag (flags are 0 or 1)"},
        {"M 0 0 A 1 1 0 0 0 5", "path data: column 20: the end where A wants a number"},
        {"M 0 0 Z 5", "path data: column 9: '5' is not a path command"},
        {"M 0 0 L 1 1 \xc3\xa9", "path data: column 13: "},
        {std::string("M 0 0 L 1 1\0", 12), "path data: column 12: '?' is not a path command"},
        {"M 0 0 L 1 1 M 5 5", "path data: column 13: a second subpath begins (give one stroke for each)"},
        {"M 0 0 L 1 1 M 5 5 L 6 6", "path data: column 13: a second subpath begins"},
        {"M 0 0 L 1 1 Z L 5 5", "path data: column 15: a second subpath begins"},
        {"M 0 0 M 1 1 L 2 2", "path data: column 7: a second subpath begins"},
        {"M 900000 0 l 900000 0", "path data: goes to 1.8e+06 mm, beyond 1e+06 mm"},
    };
    for (const sample& s : samples) {
        CAPTURE(s.data);
        const std::string got = refusal(s.data);
        CAPTURE(got);
        CHECK(got.substr(0, s.message.size()) == s.message);
    }
}

TEST_CASE("numbers may run together, as minifiers write them")
{
    CHECK(path::from_svg("M.5.5-1-2").svg() == "M 0.5 0.5 L -1 -2");
    CHECK(path::from_svg("M0 0l1e1.5").svg() == "M 0 0 L 10 0.5");
    CHECK(path::from_svg("M0,0,+3,4").svg() == "M 0 0 L 3 4");
    CHECK(path::from_svg("\n\tM0 0\r\nL3 4\f").svg() == "M 0 0 L 3 4");
    CHECK(path::from_svg("M0 0a5 5 0 0110 0").length_mm() ==
          doctest::Approx(15.70796326794897).epsilon(1e-9));
    CHECK(path::from_svg("M0 0a5 5 0 0,1,10,0,5 5 0 0,1-10,0").length_mm() ==
          doctest::Approx(31.41592653589793).epsilon(1e-9));
    CHECK(path::from_svg("M0 0L1e-400 3").svg() == "M 0 0 L 0 3");
}

TEST_CASE("svg() draws ellipses as flat as a line as lines")
{
    for (const std::string data :
         {"M0 0a5 5 0 0,0,100,1-10-1e-60 0,1010,0", "M 100 1 A 10 1e-60 0 1 0 110 1",
          "M 0 0 A 10 1e-9 0 1 1 5 0", "M 5 5 A 1e-12 20 0 0 1 5 9", "M 5 5 A 20 1e-30 90 1 0 5 9"}) {
        CAPTURE(data);
        const path p = path::from_svg(data);
        const path again = path::from_svg(p.svg());
        CHECK(again.length_mm() == doctest::Approx(p.length_mm()).epsilon(1e-9));
        for (int k = 0; k <= 100; ++k)
            CHECK(distance_mm(again.at(p.length_mm() * k / 100.0), p.at(p.length_mm() * k / 100.0)) < 1e-5);
    }
}

TEST_CASE("changed path data gives a path or an error, nothing else")
{
    std::mt19937_64 random(31337);
    const std::string alphabet = "MmLlHhVvCcSsQqTtAaZz0123456789.,-+eE \tnx\"";
    std::uniform_int_distribution<std::size_t> letter(0, alphabet.size() - 1);
    int paths = 0;
    for (int n = 0; n < tactor::test::rounds(20000); ++n) {
        std::string data = n % 3 == 0 ? "M10-5.5c1 2 3 4 5 6s1 2 3 4a5 6 7 01 8 9z"
                                      : tactor::test::random_path(random, 1 + n % 3);
        for (int change = 0; change < 1 + n % 4; ++change) {
            const std::size_t at = std::uniform_int_distribution<std::size_t>(0, data.size() - 1)(random);
            switch (std::uniform_int_distribution<int>(0, 3)(random)) {
            case 0:
                data[at] = alphabet[letter(random)];
                break;
            case 1:
                data.insert(at, 1, alphabet[letter(random)]);
                break;
            case 2:
                data.erase(at, 1);
                break;
            default:
                data.resize(at + 1);
            }
            if (data.empty())
                data.push_back('M');
        }
        CAPTURE(data);
        const std::string message = refusal(data);
        if (!message.empty())
            continue;
        ++paths;
        const path p = path::from_svg(data);
        const tactor::point middle = p.at(0.5 * p.length_mm());
        CHECK(std::isfinite(p.length_mm()));
        CHECK(std::abs(middle.x_mm) <= 1.001e6);
        CHECK(std::abs(middle.y_mm) <= 1.001e6);
        for (const double at_mm : p.meets_x(20.0))
            CHECK(std::isfinite(at_mm));
        CHECK(caught_message([&] { static_cast<void>(path::from_svg(p.svg())); }).empty());
    }
    CHECK(paths > tactor::test::rounds(2000));
}

TEST_CASE("numbers are read and written alike in a locale with a decimal comma")
{
    const std::string data = "M 0.5 1.25 C 2.5 3.5 4.5 5.5 6.5 7.25";
    const std::string csv = "t_s,x_mm,y_mm\n0.25,1.5,2.5\n1.75,3.5,4.5\n";
    const std::string svg = "<svg width='10.5mm' height='10.5mm' viewBox='0 0 21 21'>"
                            "<path d='M 1.5 2.5 L 3.5 4.5' transform='translate(0.5,1.5)'/></svg>";
    const comma_locale locale;
    if (!locale.found())
        MESSAGE("neither de_DE.UTF-8 nor fr_FR.UTF-8 is installed: make one with localedef");
    REQUIRE(locale.found());
    REQUIRE(std::string(std::localeconv()->decimal_point) == ",");
    CHECK(path::from_svg(data).svg() == data);
    const auto timed = tactor::parse_strokes_csv(csv, "a.csv");
    CHECK_FALSE(timed.at(0).start_s.has_value()); // its first line is its zero
    CHECK(timed.at(0).motion.position(1.5) == tactor::point{3.5, 4.5});
    const auto drawn = tactor::parse_strokes_svg(svg, "a.svg");
    CHECK(drawn.at(0).motion.position(0.0).x_mm == doctest::Approx(1.0));
    CHECK(drawn.at(0).motion.position(0.0).y_mm == doctest::Approx(2.0));
}

} // namespace path_svg_test
