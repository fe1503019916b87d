// SPDX-License-Identifier: MIT
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "session/say.hpp"

namespace {

using tactor::session::wrap_lines;
using tactor::session::wrap_text;

TEST_CASE("a paragraph breaks at words and keeps them all")
{
    const std::string text =
        "tactor: warning: no real-time priority: xruns are more likely (join the group audio)\n";
    for (std::size_t width = 10; width < 100; ++width) {
        const std::string lines = wrap_lines(text, width);
        std::istringstream words(lines);
        std::string joined;
        for (std::string word; words >> word;)
            joined += (joined.empty() ? "" : " ") + word;
        CHECK(joined + "\n" == text);
        std::istringstream all(lines);
        for (std::string line; std::getline(all, line);)
            CHECK((line.size() <= width || line.find(' ') == std::string::npos));
    }
}

TEST_CASE("a list of options goes on below its explanations")
{
    CHECK(wrap_lines("  --soa S          onset to onset of two bursts\n  --fit            scale\n", 40) ==
          "  --soa S          onset to onset of two\n"
          "                   bursts\n"
          "  --fit            scale\n");
    CHECK(wrap_lines("    one two three four", 14) == "    one two\n    three four");
    // On a narrow terminal they stand below the option.
    CHECK(wrap_lines("  --soa S          onset to onset of two bursts\n  --fit            scale\n", 23) ==
          "  --soa S\n"
          "    onset to onset of\n"
          "    two bursts\n"
          "  --fit\n"
          "    scale\n");
    CHECK(wrap_lines("  --level-dbfs DB\n                   peak at intensity 1", 23) ==
          "  --level-dbfs DB\n"
          "    peak at intensity 1");
    CHECK(wrap_lines("   1.0   2.0   3.0   4.0", 16) == "   1.0   2.0\n   3.0   4.0"); // a table's row
}

TEST_CASE("lines that fit, empty lines and their ends stay as they are")
{
    for (const char* text : {"", "\n", "a\n\nb", "a  b   c\n", "  a \n", "which? "})
        CHECK(wrap_lines(text, 40) == text);
}

TEST_CASE("a word without blanks is not broken")
{
    CHECK(wrap_lines("see /a/long/name/of/a/file for more", 12) == "see\n/a/long/name/of/a/file\nfor more");
    CHECK(wrap_text("file: ", "/a/long/name/of/a/file", 12) == "file: /a/long/name/of/a/file\n");
}

TEST_CASE("columns count, not bytes")
{
    CHECK(wrap_lines("für Größe über", 10) == "für Größe\nüber");
    CHECK(wrap_lines("동의 하십니까 예", 12) == "동의\n하십니까 예"); // two columns each
}

} // namespace
