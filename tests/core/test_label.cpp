// SPDX-License-Identifier: MIT
#include <string>

#include <doctest/doctest.h>

#include "core/label.hpp"

namespace label_test {

using tactor::label_fault;

TEST_CASE("a label has 1 to 40 characters of any script")
{
    CHECK(label_fault("").ends_with("is empty"));
    CHECK(label_fault("left palm").empty());
    CHECK(label_fault(std::string(40, 'x')).empty());
    CHECK(label_fault(std::string(41, 'x')) == "has 41 characters");
    std::string wide;
    for (int i = 0; i < 40; ++i)
        wide += i % 2 == 0 ? "\xc3\xa9" : "\xf0\x9f\x91\x8b"; // two and four bytes
    CHECK(label_fault(wide).empty());
    CHECK(label_fault(wide + "\xe6\x89\x8b") == "has 41 characters");
}

TEST_CASE("a label has no characters that end a line, move a cursor or turn the text around it")
{
    for (const char* c : {"\n", "\x1b[2J", "\x7f", "\xc2\x80", "\xc2\x9f", "\xe2\x80\xa8", "\xe2\x80\xae",
                          "\xe2\x81\xa6", "\xe2\x81\xa9"})
        CHECK(label_fault("a" + std::string(c) + "b") == "has control characters");
    CHECK(label_fault(std::string("a\0b", 3)) == "has control characters");
    for (const char* c :
         {" ", "~", "\xc2\xa0", "\xe2\x80\xa7", "\xe2\x80\xaf", "\xe2\x81\xa5", "\xe2\x81\xaa"})
        CHECK(label_fault(c).empty());
}

} // namespace label_test
