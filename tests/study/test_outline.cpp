// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <string>

#include <doctest/doctest.h>

#include "caught.hpp"

namespace tactor::study::test_outline {
namespace {

const std::string head =
    "[experiment]\nname = \"e\"\n"
    "[[motion]]\nname = \"a\"\n[[motion]]\nname = \"b\"\n"
    "[[method]]\nname = \"old\"\n[[method]]\nname = \"other\"\n[[method]]\nname = \"new\"\n";

std::string refusal(const std::string& text)
{
    return caught_message([&] { read_outline(text, "e.toml"); });
}

TEST_CASE("runs in order, motions and methods in the order of the definition")
{
    const experiment_outline e =
        read_outline(head + "[[run]]\nname = \"how good\"\ntask = \"rate\"\nscale = 7\ntrials = 12\n"
                            "[[run]]\nname = \"which-one\"\ntask = \"choose\"\nmethods = [\"new\", \"old\"]\n"
                            "[[run]]\nname = \"what\"\ntask = \"identify\"\nmotions = [\"b\", \"a\"]\n",
                     "e.toml");
    CHECK(e.name == "e");
    REQUIRE(e.runs.size() == 3);
    CHECK(e.runs[0].file_name == "howgood");
    CHECK(e.runs[0].methods == std::vector<std::string>{"old", "other", "new"});
    CHECK(e.runs[0].scale == 7);
    CHECK(e.runs[0].trials == 12);
    CHECK(e.runs[1].task == task_kind::choose);
    CHECK(e.runs[1].methods == std::vector<std::string>{"old", "new"});
    CHECK(e.runs[2].motions == std::vector<std::string>{"a", "b"});
}

TEST_CASE("faults have their line")
{
    CHECK(refusal("[experiment\n").find("e.toml:1:") == 0);
    CHECK(refusal("[[run]]\n").find("there is no [experiment]") != std::string::npos);
    CHECK(refusal("[experiment]\nname = 3\n").find("e.toml:2:8: name is 3") == 0);
    CHECK(refusal("[experiment]\nname = \"e\"\n").find("there is no [[motion]]") != std::string::npos);
    CHECK(refusal(head).find("there is no [[run]]") != std::string::npos);
    const auto with = [](const std::string& run) { return refusal(head + "[[run]]\n" + run); };
    CHECK(with("task = \"rate\"\n").find("[[run]] has no name") != std::string::npos);
    CHECK(with("name = \"-\"\ntask = \"rate\"\n").find("no letter or digit") != std::string::npos);
    CHECK(with("name = \"r\"\ntask = \"guess\"\n").find("e.toml:15:8: task is 'guess'") == 0);
    CHECK(with("name = \"r\"\ntask = \"choose\"\n").find("r has 3 methods to choose from") !=
          std::string::npos);
    CHECK(with("name = \"r\"\ntask = \"rate\"\nmotions = [\"c\"]\n")
              .find("motions has what is not defined (one of a, b)") != std::string::npos);
    for (const char* beyond : {"scale = 1", "scale = 10", "trials = 0", "trials = 10001"})
        CHECK(with(std::string("name = \"r\"\ntask = \"rate\"\n") + beyond + "\n").find("e.toml:16:") == 0);
    CHECK(with("name = \"r\"\ntask = \"identify\"\nmotions = [\"a\"]\n").find("one motion to identify") !=
          std::string::npos);
    CHECK(with("name = \"r 1\"\ntask = \"rate\"\n[[run]]\nname = \"r-1\"\ntask = \"rate\"\n")
              .find("\"r 1\" and \"r-1\" would have one name") != std::string::npos);
    CHECK(refusal(head + "[[method]]\nname = \"old\"\n").find("the method \"old\" is there twice") !=
          std::string::npos);
    CHECK(refusal(head + "[[motion]]\nname = \"a\\tb\"\n").find("no such name") != std::string::npos);
}

TEST_CASE("keys that the analysis does not need are skipped")
{
    CHECK(refusal("[masking]\nnoise = 7\n" + head +
                  "algorithm = 7\nnew = true\n[[run]]\nname = \"r\"\ntask = \"choose\"\nscale = 7\n"
                  "attribute = \"likeness\"\nmethods = [\"old\", \"new\"]\nbreak = \"long\"\n[other]\n")
              .empty());
}

TEST_CASE("a key of very many parts is refused before it fills the stack, dots in a text are not")
{
    std::string key = "a";
    for (int i = 0; i < 200000; ++i)
        key += ".a";
    CHECK(refusal(head + key + " = 1\n").find("e.toml:13:34: a key of too many parts") == 0);
    CHECK(refusal(head + "[" + key + "]\n").find("too many parts") != std::string::npos);
    const std::string run = "[[run]]\nname = \"r\"\ntask = \"rate\"\n";
    CHECK(refusal(head + run + "x = \"....................\"\n").empty());
    CHECK(refusal(head + run +
                  "x = \"\"\"\n....................\n\\\" .................\n\"\"\" # .................\n")
              .empty());
    CHECK(refusal(head + run +
                  "x = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, "
                  "1.0]\n")
              .empty());
}

} // namespace
} // namespace tactor::study::test_outline
