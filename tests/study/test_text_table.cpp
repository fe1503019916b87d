// SPDX-License-Identifier: MIT
#include "study/data/text_table.hpp"

#include <string>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "folder.hpp"
#include "message_of.hpp"

namespace tactor::study::test_text_table {
namespace {

std::string refusal(const std::string& text)
{
    const folder f;
    f.write("t.tsv", text);
    const std::string said = message_of([&] { text_table t(f / "t.tsv"); });
    return said.empty() ? said : said.substr(f.path().string().size() + 1);
}

TEST_CASE("cells by name, n/a as nothing, lines of any system")
{
    const folder f;
    f.write("t.tsv", "\xef\xbb\xbftrial\tmotion\tx\r\n1\tone two\t0.5\r\n2\tn/a\tn/a\r\n");
    const text_table t(f / "t.tsv");
    REQUIRE(t.rows() == 2);
    CHECK(t.has("motion"));
    CHECK(!t.has("Motion"));
    CHECK(*t.cell(0, "motion") == "one two");
    CHECK(!t.cell(1, "motion"));
    CHECK(*t.whole(1, "trial", 1, 9) == 2);
    CHECK(*t.number(0, "x") == 0.5);
    CHECK(!t.number(1, "x"));
    CHECK(message_of([&] { t.need(1, "motion"); }).find("t.tsv:3: motion is missing") != std::string::npos);
    CHECK(message_of([&] { t.cell(0, "y"); }).find("t.tsv:1: there is no column y") != std::string::npos);
    CHECK(message_of([&] {
              t.whole(1, "trial", 3, 9);
          }).find("t.tsv:3: trial is \"2\" (a whole number from 3 to 9)") != std::string::npos);
    CHECK(message_of([&] { t.whole(0, "x", 0, 9); }).find("x is \"0.5\"") != std::string::npos);
    CHECK(message_of([&] { t.number(0, "motion"); }).find("t.tsv:2: motion is \"one two\"") !=
          std::string::npos);
}

TEST_CASE("numbers that are none are refused")
{
    const folder f;
    f.write("t.tsv", "x\nnan\ninf\n1e999\n0x1\n 1\n1 \n-1\n4294967296\n");
    const text_table t(f / "t.tsv");
    for (std::size_t row = 0; row < t.rows(); ++row)
        CHECK(!message_of([&] { t.whole(row, "x", 0, 9); }).empty());
    for (std::size_t row = 0; row < 6; ++row)
        CHECK(!message_of([&] { t.number(row, "x"); }).empty());
}

TEST_CASE("a table that is not whole says where")
{
    CHECK(refusal("").find("t.tsv: it is empty") == 0);
    CHECK(refusal("a\tb\n1\t2\n3\n").find("t.tsv:3: it has 1 columns, not 2") == 0);
    CHECK(refusal("a\tb\n1\t2\t3\n").find("t.tsv:2: it has 3 columns, not 2") == 0);
    CHECK(refusal("a\tb\n1\t\n").find("t.tsv:2: a cell is empty") == 0);
    CHECK(refusal("a\tb\n\n").find("t.tsv:2: it has 1 columns, not 2") == 0);
    CHECK(refusal("a\ta\n1\t2\n").find("t.tsv:1: the column a is there twice") == 0);
    CHECK(refusal("a\tb\n1\t2").find("t.tsv:2: the last line has no end") == 0);
    CHECK(refusal(std::string("a\n\0\n", 4)).find("t.tsv:2: a cell is empty") == 0);
    CHECK(refusal("a\tb\n1\t2\n").empty());
}

TEST_CASE("what is no file is not waited for")
{
    const folder f;
    REQUIRE(::mkfifo((f / "pipe").c_str(), 0600) == 0);
    CHECK(message_of([&] { read_file(f / "pipe"); }).find("it is no file") != std::string::npos);
    CHECK(message_of([&] { read_file(f.path()); }).find("it is no file") != std::string::npos);
    CHECK(message_of([&] { read_file(f / "none"); }).find("No such file") != std::string::npos);
    f.write("large", std::string(20, 'x'));
    CHECK(message_of([&] { read_file(f / "large", 19); }).find("longer than 0 MB") != std::string::npos);
    CHECK(read_file(f / "large", 20).size() == 20);
}

} // namespace
} // namespace tactor::study::test_text_table
