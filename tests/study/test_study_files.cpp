// SPDX-License-Identifier: MIT
// Files of a study's folder.
#include <filesystem>
#include <optional>
#include <string>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "folder.hpp"
#include "study/bids/disk.hpp"
#include "study/bids/study_folder.hpp"
#include "study/data/columns.hpp"

namespace tactor::study::test_study_files {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a description records whether its sessions are simulated, where tactor wrote it")
{
    experiment_definition d;
    CHECK(says_simulated(dataset_text(d, true)) == true);
    CHECK(says_simulated(dataset_text(d, false)) == false);
    for (const char* text :
         {"", "[]", "{}", R"({"GeneratedBy": "tactor experiment"})", R"({"GeneratedBy": []})",
          R"({"GeneratedBy": [1, {"Description": 2}, {"Description": "by hand"}]})"})
        CHECK(says_simulated(text) == std::nullopt);
    CHECK(says_simulated(
              R"({"GeneratedBy": [{"Name": "x"}, {"Description": "tactor experiment --simulate. x"}]})") ==
          true);
}

TEST_CASE("a cut off part of a file is kept under a free name")
{
    const folder f;
    const fs::path file = f.write("t.tsv", "a\n1\n23");
    CHECK(cut_file(file, 4) == f / "t.tsv.cut-1");
    CHECK(f.bytes("t.tsv") == "a\n1\n");
    CHECK(f.bytes("t.tsv.cut-1") == "23");
    CHECK(cut_file(file, 3) == f / "t.tsv.cut-2");
    CHECK(f.bytes("t.tsv") == "a\n1");
    CHECK(f.bytes("t.tsv.cut-1") == "23");
    CHECK(f.bytes("t.tsv.cut-2") == "\n");
    CHECK(f.names() == std::vector<std::string>{"t.tsv", "t.tsv.cut-1", "t.tsv.cut-2"});
}

TEST_CASE("text is appended, and a missing file is reported")
{
    const folder f;
    const fs::path file = f.write("t.tsv", "a\n");
    append_text(file, "1\n");
    append_text(file, "2\n", false);
    CHECK(f.bytes("t.tsv") == "a\n1\n2\n");
    CHECK_THROWS_AS(append_text(f / "none.tsv", "1\n"), error);
    CHECK_THROWS_AS(append_text(f.path(), "1\n"), error);
    CHECK_THROWS_AS(append_text("/dev/full", "1\n"), error);
}

TEST_CASE("a table of an older version has no column early")
{
    trial_row row;
    row.trial = 1;
    row.early = true;
    const named_cells cells = make_cells(row);
    named_cells older = cells;
    std::erase_if(older, [](const auto& c) { return c.first == "early"; });
    const auto read = [](const named_cells& c) {
        return read_rows(text_table("t.tsv", text_table("", header_line(c)).with_line(c))).front().early;
    };
    CHECK(read(cells) == true);
    CHECK(read(older) == std::nullopt);
}

// A table with one line, without its end.
bool cut_in_plan(const std::string& columns, const std::string& line)
{
    return is_cut_in_plan(text_table("t.tsv", columns + "\n" + line, last_line::may_be_cut));
}

TEST_CASE("an incomplete last plan makes a line a cut off one")
{
    const std::string hash(64, 'a');
    const std::string two = "method_2\tplan_1\tplan_2";
    CHECK_FALSE(cut_in_plan(two, "b\t" + hash + "\t" + hash));
    CHECK(cut_in_plan(two, "b\t" + hash + "\t" + hash.substr(1)));
    CHECK(cut_in_plan(two, "b\t" + hash + "\t"));
    CHECK_FALSE(cut_in_plan(two, "n/a\t" + hash + "\tn/a"));
    CHECK_FALSE(cut_in_plan(two, "n/a\t" + hash + "\t"));
    CHECK(cut_in_plan(two, "n/a\t" + hash + "\tn/"));
    CHECK(cut_in_plan(two, "n/a\t" + hash + "\tn"));
    CHECK_FALSE(cut_in_plan(two, "b\t" + hash + "\tshort\n"));
    CHECK(cut_in_plan("method_2\tplan_2\tplan_1", "n/a\tn/a\tn/a"));
    CHECK_FALSE(cut_in_plan("method_2\tplan_2\tplan_1", "n/a\tn/a\t" + hash));
    CHECK_FALSE(cut_in_plan("plan_1\tnote", hash + "\tn"));
}

} // namespace
} // namespace tactor::study::test_study_files
