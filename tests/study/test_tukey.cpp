// SPDX-License-Identifier: MIT

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "study/statistics/tests.hpp"

namespace tactor::study::test_tukey {
namespace {

TEST_CASE("the studentized range matches its definition, integrated by R")
{
    struct known {
        double q;
        std::size_t levels;
        double df;
        double p;
    };
    // integrate() twice over the definition, relative tolerance 1e-9 (R's ptukey is off by 1e-3 with df 2, by
    // 3e-7 with 50 levels).
    for (const known& k : {known{3.5, 4, 33, 0.0827866510280034}, known{40, 10, 2, 0.00629123165036593},
                           known{4, 50, 1000, 0.769333841286478}, known{1, 2, 1, 0.608173447969393},
                           known{200, 4, 1, 0.00821299674580652}})
        CHECK(studentized_range_p(k.q, k.levels, k.df) == doctest::Approx(k.p).epsilon(1e-9));
    // R's ptukey where that is good
    CHECK(std::abs(studentized_range_p(10, 4, 33) - 2.5138566073224e-07) < 1e-11);
    CHECK(std::abs(studentized_range_p(0.1, 3, 5) - 0.997248706663421) < 1e-8);
}

TEST_CASE("with two levels it is Student's t, also where that is small")
{
    for (const double df : {1.0, 2.0, 7.0, 33.0, 500.0, 100000.0})
        for (const double q : {0.001, 0.5, 3.0, 9.0}) {
            const double p = p_of_t(q / std::numbers::sqrt2, df);
            CHECK(std::abs(studentized_range_p(q, 2, df) - p) < 1e-6 * p);
            CHECK(std::abs(studentized_range_p(q, 2, df) - p) < 1e-11);
        }
}

TEST_CASE("it is 1 for no range, never above, and falls")
{
    CHECK(studentized_range_p(0.0, 4, 33) == 1.0);
    double last = 1.0;
    for (double q = 0.0; q < 50.0; q += 0.37) {
        const double p = studentized_range_p(q, 5, 12);
        CHECK(p <= last);
        CHECK(p >= 0.0);
        last = p;
    }
    CHECK(studentized_range_p(1e9, 5, 200) < 1e-20);
    CHECK(studentized_range_p(3.0, 1000, 50) == doctest::Approx(1.0));
}

TEST_CASE("all pairs in order; without an error differences alone")
{
    const auto pairs = tukey({1.0, 3.0, 2.0}, 4, 1.0, 9.0);
    REQUIRE(pairs.size() == 3);
    CHECK(pairs[0].a == 0);
    CHECK(pairs[0].b == 1);
    CHECK(pairs[0].difference == -2.0);
    CHECK(*pairs[0].q == 4.0);
    CHECK(*pairs[1].p == studentized_range_p(2.0, 3, 9.0));
    CHECK(pairs[2].difference == 1.0);
    CHECK(!tukey({1.0, 3.0}, 4, 0.0, 3.0)[0].q);
    CHECK(!tukey({1.0, 3.0}, 1, std::nullopt, 0.0)[0].p);
}

} // namespace
} // namespace tactor::study::test_tukey
