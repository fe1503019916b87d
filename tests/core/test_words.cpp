// SPDX-License-Identifier: MIT
#include <limits>

#include <doctest/doctest.h>

#include "core/words.hpp"

namespace words_test {

using tactor::counted;
using tactor::plain_number;
using tactor::seconds_text;

TEST_CASE("only one is singular")
{
    CHECK(counted(0, "burst") == "0 bursts");
    CHECK(counted(1, "burst") == "1 burst");
    CHECK(counted(2, "burst") == "2 bursts");
    CHECK(counted(1, "try", "tries") == "1 try");
    CHECK(counted(3, "try", "tries") == "3 tries");
}

TEST_CASE("numbers have no exponent and no zeros at their end")
{
    CHECK(plain_number(0.0) == "0");
    CHECK(plain_number(-0.0) == "0");
    CHECK(plain_number(0.07) == "0.07");
    CHECK(plain_number(2.6179938) == "2.61799");
    CHECK(plain_number(2.6179938, 3) == "2.62");
    CHECK(plain_number(1e6) == "1000000");
    CHECK(plain_number(-1e9) == "-1000000000");
    CHECK(plain_number(1e-5) == "0.00001");
    CHECK(plain_number(1e-30) == "0");
    CHECK(plain_number(-1e-30) == "0");
    CHECK(plain_number(9.9999999) == "10");
    CHECK(plain_number(std::numeric_limits<double>::infinity()) == "inf");
}

TEST_CASE("times have their unit, and a rounding is no time")
{
    CHECK(seconds_text(0.0) == "0 s");
    CHECK(seconds_text(1e-17) == "0 s");
    CHECK(seconds_text(-1e-17) == "0 s");
    CHECK(seconds_text(2.78521e-08) == "27.9 ns");
    CHECK(seconds_text(2.78521e-05) == "27.9 us");
    CHECK(seconds_text(1e-4) == "0.0001 s");
    CHECK(seconds_text(0.0473) == "0.0473 s");
    CHECK(seconds_text(2.6179938) == "2.61799 s");
    CHECK(seconds_text(2.6179938, 4) == "2.618 s");
    CHECK(seconds_text(86400.0) == "86400 s");
    CHECK(seconds_text(-0.5) == "-0.5 s");
}

} // namespace words_test
