// SPDX-License-Identifier: MIT
// Files of a study's folder, and tables.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "study/bids/dataset.hpp"
#include "study/bids/disk.hpp"
#include "study/bids/study_folder.hpp"
#include "study/data/text_table.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study::test_study_files {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a description records whether its sessions are simulated, where tactor wrote it")
{
    experiment_definition d;
    CHECK(parse_simulated_flag(dataset_text(d, true)) == true);
    CHECK(parse_simulated_flag(dataset_text(d, false)) == false);
    for (const char* text :
         {"", "[]", "{}", R"({"GeneratedBy": "tactor experiment"})", R"({"GeneratedBy": []})",
          R"({"GeneratedBy": [1, {"Description": 2}, {"Description": "by hand"}]})"})
        CHECK(parse_simulated_flag(text) == std::nullopt);
    CHECK(parse_simulated_flag(
              R"({"GeneratedBy": [{"Name": "x"}, {"Description": "tactor experiment --simulate. x"}]})") ==
          true);
}

TEST_CASE("a study's folder that cannot be opened is not left behind, but one that was there is")
{
    const folder f;
    const experiment_definition d;
    const std::string longer_than_a_name(300, 'a');
    for (const bool was_there : {false, true}) {
        const fs::path study = f / (was_there ? "old" : "new");
        if (was_there)
            fs::create_directory(study);
        CHECK_FALSE(caught_message([&] { study_folder(study, d, longer_than_a_name, true); }).empty());
        CHECK(fs::exists(study) == was_there);
    }
}

TEST_CASE("a cut off part of a file is kept under a free name")
{
    const folder f;
    const fs::path file = f.write("t.tsv", "a\n1\n23");
    CHECK(split_file(file, 4) == f / "t.tsv.cut-1");
    CHECK(f.bytes("t.tsv") == "a\n1\n");
    CHECK(f.bytes("t.tsv.cut-1") == "23");
    CHECK(split_file(file, 3) == f / "t.tsv.cut-2");
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
    const run_outline none{.name = "r", .file_name = "r", .task = &find_task("choose")};
    trial_row row;
    row.trial = 1;
    row.early = true;
    const named_cells cells = make_cells(row, {&none});
    named_cells older = cells;
    std::erase_if(older, [](const auto& c) { return c.first == "early"; });
    const auto read = [&none](const named_cells& c) {
        return read_rows(text_table("t.tsv", text_table("", header_line(c)).text_with_line(c)), none)
            .front()
            .early;
    };
    CHECK(read(cells) == true);
    CHECK(read(older) == std::nullopt);
}

// A table with one line, without its end.
bool cut_in_plan(const std::string& columns, const std::string& line)
{
    return has_cut_plan_hash(text_table("t.tsv", columns + "\n" + line, last_line::may_be_cut));
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
    CHECK(cut_in_plan("method_3\tplan_3", "b\t" + hash.substr(1)));
    CHECK_FALSE(cut_in_plan("method_3\tplan_3", "b\t" + hash));
}

std::string refusal(const std::string& text)
{
    const folder f;
    f.write("t.tsv", text);
    const std::string message = caught_message([&] { text_table t(f / "t.tsv"); });
    return message.empty() ? message : message.substr(f.path().string().size() + 1);
}

TEST_CASE("cells by name, n/a as missing, lines of any system")
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
    has(caught_message([&] { t.need(1, "motion"); }), "t.tsv:3: motion is missing");
    has(caught_message([&] { t.cell(0, "y"); }), "t.tsv:1: the column y is missing");
    has(caught_message([&] { t.whole(1, "trial", 3, 9); }),
        "t.tsv:3: trial is \"2\" (give a whole number from 3 to 9)");
    has(caught_message([&] { t.whole(0, "x", 0, 9); }), "x is \"0.5\"");
    has(caught_message([&] { t.number(0, "motion"); }), "t.tsv:2: motion is \"one two\"");
}

TEST_CASE("bad numbers are refused")
{
    const folder f;
    f.write("t.tsv", "x\nnan\ninf\n1e999\n0x1\n 1\n1 \n-1\n4294967296\n");
    const text_table t(f / "t.tsv");
    for (std::size_t row = 0; row < t.rows(); ++row)
        CHECK(!caught_message([&] { t.whole(row, "x", 0, 9); }).empty());
    for (std::size_t row = 0; row < 6; ++row)
        CHECK(!caught_message([&] { t.number(row, "x"); }).empty());
}

TEST_CASE("an incomplete table is refused with the place")
{
    CHECK(refusal("").find("t.tsv: it is empty") == 0);
    CHECK(refusal("a\tb\n1\t2\n3\n").find("t.tsv:3: the line has 1 column, not 2") == 0);
    CHECK(refusal("a\tb\n0\t2\t3\n").find("t.tsv:2: the line has 3 columns, not 2") == 0);
    CHECK(refusal("a\ta\n1\t2\n").find("t.tsv:1: the column a occurs twice") == 0);
    CHECK(refusal("a\tb\n1").find("t.tsv:2: the line has 1 column, not 2") == 0);
    CHECK(refusal(std::string("a\n\0\n", 4)).find("t.tsv:2: the line is not UTF-8") == 0);
    CHECK(refusal("a\n\xe4\n").find("t.tsv:2: the line is not UTF-8") == 0);
    // A character of four bytes, one with a byte too few, one with a byte too many.
    CHECK(refusal("a\n\xf0\x9f\x91\x8b\n").empty());
    CHECK(refusal("a\n\xf0\x9f\x91\n").find("t.tsv:2: the line is not UTF-8") == 0);
    CHECK(refusal("a\n\xf0\x9f\x91\x8b\x8b\n").find("t.tsv:2: the line is not UTF-8") == 0);
    CHECK(refusal("a\tb\n1\t2\n").empty());
}

TEST_CASE("unreadable tables of other programs are named")
{
    CHECK(refusal("a,b\n1,2\n").find("t.tsv:1: commas separate the columns, not tabs (save it with tabs") ==
          0);
    CHECK(refusal("\"a\";\"b\"\n1;2\n").find("t.tsv:1: semicolons separate the columns") == 0);
    CHECK(refusal("\"a\" \"b\"\n1 2\n").find("t.tsv:1: spaces separate the columns") == 0);
    CHECK(refusal(std::string("\xff\xfe"
                              "a\0\t\0b\0\n\0",
                              10))
              .find("t.tsv: it is UTF-16, not UTF-8 (save it as UTF-8") == 0);
    CHECK(refusal(std::string("a\0\t\0b\0\n\0", 8)).find("t.tsv: it is UTF-16") == 0);
    CHECK(refusal("PK\x03\x04...")
              .find("t.tsv: it is a ZIP archive or office document, not text (save it as text with tabs") ==
          0);
    CHECK(refusal("\ta\n0\t5\n").find("t.tsv:1: a column has no name (leave out row numbers") == 0);
    CHECK(refusal("\"a\"\t\"b\"\n\"1\"\t2\t3\n").find("t.tsv:2: the line begins with a row number") == 0);
}

// Reads a table of the columns a and b, and returns its cells.
std::string read(const std::string& text)
{
    const folder f;
    const text_table t(f.write("t.tsv", text));
    std::string all;
    for (std::size_t row = 0; row < t.rows(); ++row)
        for (const char* column : {"a", "b"})
            all += std::string(t.cell(row, column).value_or("-")) + (*column == 'a' ? " " : "; ");
    return all;
}

TEST_CASE("tables of spreadsheets, R and pandas are read correctly")
{
    const std::string all = "x 2; - 4; ";
    for (const char* text :
         {"a\tb\nx\t2\nn/a\t4\n", "a\tb\r\nx\t2\r\nn/a\t4\r\n", "a\tb\rx\t2\rn/a\t4\r",
          "a\tb\rx\t2\nn/a\t4\r\n",
          "\xef\xbb\xbf"
          "a\tb\nx\t2\nn/a\t4\n",
          "a\tb\nx\t2\nn/a\t4", "a\tb\rx\t2\rn/a\t4", "a\tb\nx\t2\n\n\t4\n\n\t\n",
          "\"a\"\t\"b\"\n\"x\"\t2\nNA\t4\n", "\"a\"\t\"b\"\n\"x\"\t\"2\"\n\"n/a\"\t4",
          "a\tb\t\t\nx\t2\t\t\nn/a\t4\t\n\t\t\n", "\n\na\tb\nx\t2\n\nn/a\t4\n", "c\tb\ta\n1\t2\tx\n\t4\t\n"})
        CHECK(read(text) == all);
    CHECK(read("a\tb\n\"NA\"\t\"\"\"q\"\"\tand\na line\"\n\"x\ty\n") == "NA \"q\"\tand\na line; \"x y; ");
    CHECK(read("a\tb\n5\"\tx\"y\"\n\"z\" z\t\"\n") == "5\" x\"y\"; \"z\" z \"; ");
}

TEST_CASE("truths in any case, whole numbers with a point")
{
    const folder f;
    const text_table t(f.write("t.tsv", "a\tb\nTRUE\t3.0\nFalse\t3.5\ntrue\t-1.0\nyes\t4294967296\n"));
    CHECK(t.truth(0, "a"));
    CHECK_FALSE(t.truth(1, "a"));
    CHECK(t.truth(2, "a"));
    has(caught_message([&] { t.truth(3, "a"); }), "t.tsv:5: a is \"yes\" (give true or false)");
    CHECK(*t.whole(0, "b", 0, 9) == 3);
    CHECK(*t.whole(0, "b", 3, 3) == 3);
    for (std::size_t row = 1; row < 4; ++row)
        has(caught_message([&] { t.whole(row, "b", 0, 4294967295U); }), "a whole number from 0");
    has(caught_message([&] { t.whole(0, "b", 4, 9); }), "b is \"3.0\" (give a whole number from 4 to 9)");
    has(caught_message([&] { t.whole(0, "b", 0, 2); }), "b is \"3.0\"");
}

TEST_CASE("lines are counted like in an editor")
{
    CHECK(refusal("a\tb\r\n\r\n\"x\r\ny\"\t2\r\n3\r\n").find("t.tsv:5: the line has 1 column, not 2") == 0);
    CHECK(refusal("a\tb\r\r1\t2\r3").find("t.tsv:4: ") == 0);
}

// Returns the text that is written when a line with a 7 in column a comes behind a table.
std::string added(const std::string& text, std::string seven = "7")
{
    const text_table t("t.tsv", text);
    const std::string all = t.text_with_line({{"a", std::move(seven)}, {"none", "8"}});
    REQUIRE(all.starts_with(text));
    return all.substr(text.size());
}

TEST_CASE("a line fills the existing columns, and ends like the others")
{
    CHECK(added("a\tb\n1\t2\n") == "7\tn/a\n");
    CHECK(added("b\ta\n1\t2\n") == "n/a\t7\n");
    CHECK(added("a\tb\r\n1\t2\r\n") == "7\tn/a\r\n");
    CHECK(added("a\tb\r1\t2\r") == "7\tn/a\r");
    CHECK(added("a\tb\r1\t2") == "\r7\tn/a\r");
    CHECK(added("a\tb\n1\t2") == "\n7\tn/a\n");
    CHECK(added("a\tb\n1\t") == "n/a\n7\tn/a\n");
    CHECK(added("a\tb\n1\t\"\"") == "\n7\tn/a\n"); // n/a behind "" would be a part of it
    CHECK(added("a\tb\n1\t2\t") == "\n7\tn/a\n");
    CHECK(added("a") == "\n7\n");
    CHECK(added("a\t\n1\t\n\n") == "7\n");
    CHECK(added("\"a\"\n") == "7\n");
    CHECK(added("a\n", "NA") == "\"NA\"\n");
    CHECK(added("a\n", "\"x\"") == "\"\"\"x\"\"\"\n");
    CHECK(added("a\n", "x\ty") == "\"x\ty\"\n");
    // R takes a mark anywhere for the begin of a text, and loses the rows until the next one.
    CHECK(added("a\n", "6\" tall") == "\"6\"\" tall\"\n");
    CHECK(added("a\n", "it's") == "\"it's\"\n");
}

TEST_CASE("cells change in their place")
{
    const text_table t("t.tsv", "\xef\xbb\xbf"
                                "a\t\"b\"\tc\r\n1\t\"2\"\t3\r\n4\t\"5\"\t6\r\n\r\n");
    CHECK(t.text_with_cells(1, {{"b", "true"}, {"a", "44"}}) ==
          "\xef\xbb\xbf"
          "a\t\"b\"\tc\r\n1\t\"2\"\t3\r\n44\ttrue\t6\r\n\r\n");
}

TEST_CASE("an incomplete last line is cut off, where allowed")
{
    const std::string text = "a\tb\n1\t2\n";
    const auto cut = [&](const std::string& rest) {
        const text_table t("t.tsv", text + rest, last_line::may_be_cut);
        CHECK(t.rows() == (t.cut_position() ? 1 : 2));
        return t.cut_position();
    };
    CHECK(cut("3") == text.size());
    CHECK(cut(std::string("3\t4\0\0", 5)) == text.size());
    CHECK_FALSE(cut("3\t4"));
    CHECK_FALSE(cut("3\t"));
    CHECK(caught_message([&] {
              text_table("t.tsv", text + "3\n", last_line::may_be_cut);
          }).find("t.tsv:3: the line has 1 column") == 0);
    text_table t("t.tsv", text + "3\tx", last_line::may_be_cut);
    CHECK(t.is_open());
    t.drop_last_row();
    CHECK_FALSE(t.is_open());
    CHECK(t.rows() == 1);
    CHECK(caught_message([&] { t.refuse_cut("mend it"); }) ==
          "t.tsv:3: the last line is incomplete (mend it)");
}

TEST_CASE("a study's lines are read with the types of their columns, void ones too")
{
    const folder f;
    f.write("participants.tsv", "participant_id\nsub-01\nsub-02\n");
    f.write("sourcedata/sub-01/session.json",
            R"({"simulated": true, "experiment": {"text": "[experiment]\nname = \"x\"\n[[motion]]\nname = )"
            R"(\"up\"\n[[method]]\nname = \"a\"\n[[run]]\nname = \"how-far\"\ntask = \"rate\"\n"}})");
    const auto write = [&](const std::string& first_time) {
        f.write("sub-01/beh/sub-01_task-howfar_beh.tsv",
                "trial\tattempt\tmotion\tmethod_1\tresponse\trating\tresponse_time\tvoid\tframe_1\tnote\n"
                "1\t1\tup\ta\tn/a\tn/a\t" +
                    first_time +
                    "\ttrue\t9000000000\tcoughed\n"
                    "1\t2\tup\ta\t4\t4\t0.5\tfalse\tn/a\tn/a\n");
        return read_study(f.path(), {});
    };
    const std::vector<trial_cells> all = write("n/a");
    REQUIRE(all.size() == 2);
    const auto cell = [&](std::size_t line, std::string_view name) {
        const auto at = std::ranges::find(all[line], name, &trial_cells::value_type::first);
        REQUIRE(at != all[line].end());
        return at->second;
    };
    CHECK(all[0].size() == 4 + trial_columns.size() + 1);
    CHECK(cell(0, "participant") == cell_value(std::string("01")));
    CHECK(cell(0, "run") == cell_value(std::string("how-far")));
    CHECK(cell(0, "task") == cell_value(std::string("rate")));
    CHECK(cell(0, "simulated") == cell_value(true));
    CHECK(cell(0, "void") == cell_value(true));
    CHECK(cell(0, "response_time") == cell_value());
    CHECK(cell(0, "frame_1") == cell_value(std::uint64_t{9000000000}));
    CHECK(cell(0, "note") == cell_value(std::string("coughed")));
    CHECK(cell(1, "attempt") == cell_value(std::uint64_t{2}));
    CHECK(cell(1, "rating") == cell_value(std::uint64_t{4}));
    CHECK(cell(1, "response") == cell_value(std::string("4")));
    CHECK(cell(1, "response_time") == cell_value(0.5));
    CHECK(cell(1, "void") == cell_value(false));
    CHECK(cell(1, "xruns") == cell_value()); // not a column of the table
    CHECK(cell(1, "note") == cell_value());
    has(caught_message([&] { write("0,5"); }), "_beh.tsv:2: response_time is \"0,5\"");
    CHECK(os_code([&] { read_study(f / "none", {}); }) == ENOENT);
    CHECK(os_code([&] { read_study(f / "participants.tsv", {}); }) == ENOTDIR);
}

TEST_CASE("anything other than a file is refused at once")
{
    const folder f;
    REQUIRE(::mkfifo((f / "pipe").c_str(), 0600) == 0);
    has(caught_message([&] { read_file(f / "pipe"); }), "it is not a regular file");
    has(caught_message([&] { read_file(f.path()); }), "it is not a regular file");
    has(caught_message([&] { read_file(f / "none"); }), "No such file");
    f.write("some", "text");
    CHECK(read_file(f / "some") == "text");
}

} // namespace
} // namespace tactor::study::test_study_files
