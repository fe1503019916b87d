// SPDX-License-Identifier: MIT
// Other channels in an array file's own text.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <tactor/setup.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
#include "folder.hpp"

namespace channel_map_test {

using namespace tactor;
namespace fs = std::filesystem;

namespace {

std::string changed(const std::string& text, const std::vector<unsigned>& channels)
{
    const folder f;
    return detail::with_channels(f.write("a.toml", text), channels);
}

} // namespace

TEST_CASE("only the channels of a list change; comments, order and blanks stay")
{
    CHECK(changed("# mine\n[[tactor]]  # thumb \u00e4\u00f6\nx_mm = 0.0\ny_mm = 0.0\nchannel = 10   # was "
                  "9\ngain_db = -1\n"
                  "[[tactor]]\nchannel = 2\nx_mm = 20.0\ny_mm = 0.0\n[output]\npcm = \"null\"\n",
                  {2, 10}) ==
          "# mine\n[[tactor]]  # thumb \u00e4\u00f6\nx_mm = 0.0\ny_mm = 0.0\nchannel = 2   # was 9\ngain_db "
          "= -1\n"
          "[[tactor]]\nchannel = 10\nx_mm = 20.0\ny_mm = 0.0\n[output]\npcm = \"null\"\n");
}

TEST_CASE("an entry without a channel gets one below its header")
{
    CHECK(changed("[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]] # two\nx_mm = 1\ny_mm = 0", {1, 0}) ==
          "[[tactor]]\nchannel = 1\nx_mm = 0\ny_mm = 0\n[[tactor]] # two\nchannel = 0\nx_mm = 1\ny_mm = 0");
    CHECK(changed("tactor = [ { x_mm = 0, y_mm = 0 },\n  { x_mm = 1, y_mm = 0, channel = 1 } ]\n", {1, 0}) ==
          "tactor = [ { channel = 1, x_mm = 0, y_mm = 0 },\n  { x_mm = 1, y_mm = 0, channel = 0 } ]\n");
}

TEST_CASE("a grid gets entries for the tactors that change, at the end; entries that are there are used")
{
    CHECK(changed("[array]\ngrid = { rows = 1, columns = 3, pitch_mm = 20.0 }\n[[tactor]]\ntactor = "
                  "2\ngain_db = -3\n"
                  "[limits]\nmax_drive_s = 2",
                  {0, 2, 1}) ==
          "[array]\ngrid = { rows = 1, columns = 3, pitch_mm = 20.0 }\n[[tactor]]\nchannel = 1\ntactor = 2\n"
          "gain_db = -3\n[limits]\nmax_drive_s = 2\n\n[[tactor]]\ntactor = 1\nchannel = 2\n");
}

TEST_CASE("a map that is right leaves the text alone")
{
    const std::string text = "[array]\npreset = \"palm-2x4\"   # no end of line";
    CHECK(changed(text, {0, 1, 2, 3, 4, 5, 6, 7}) == text);
}

TEST_CASE("the array of another file is changed where it is used")
{
    const folder f;
    f.write("base.toml", "[array]\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n");
    CHECK(detail::with_channels(f.write("a.toml", "[array]\nfile = \"base.toml\"\n"),
                                std::vector<unsigned>{1, 0}) ==
          "[array]\nfile = \"base.toml\"\n\n[[tactor]]\ntactor = 0\nchannel = 1\n\n[[tactor]]\ntactor = 1\n"
          "channel = 0\n");
}

TEST_CASE("channels that the file cannot have, or cannot express, are refused")
{
    const std::string grid = "[array]\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n";
    CHECK(caught_message([&] { changed(grid, {0}); }).find("1 channel for 2 tactors") != std::string::npos);
    CHECK(caught_message([&] { changed(grid, {1, 1}); }).find("channel 1") != std::string::npos);
    CHECK(caught_message([&] {
              changed(grid + "[output]\nchannels = 2\n", {0, 2});
          }).find("channels is 2") != std::string::npos);
    CHECK(caught_message([&] { changed("[output]\nrate = 48000\n", {0}); }).find("says no [array]") !=
          std::string::npos);
    // An array that is closed by its brackets takes no further entry.
    CHECK_THROWS_AS(changed(grid + "tactor = [ { tactor = 0, gain_db = -1 } ]\n", {1, 0}), error);
}

TEST_CASE("every example array can be turned round")
{
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(TACTOR_SOURCE_ROOT) / "examples/arrays")) {
        CAPTURE(entry.path().string());
        std::vector<unsigned> channels;
        const setup before = load_setup(entry.path());
        for (const tactor_spec& t : before.array->tactors)
            channels.insert(channels.begin(), t.channel);
        const setup after = parse_setup(detail::with_channels(entry.path(), channels), "after");
        for (std::size_t i = 0; i < channels.size(); ++i)
            CHECK(after.array->tactors[i].channel == channels[i]);
        ++files;
    }
    CHECK(files >= 4);
}

TEST_CASE("an error tells its parts apart")
{
    const error full(error_kind::bad_input, "a: b", "c (d)", "e (f)");
    CHECK(full.subject() == "a: b");
    CHECK(full.why() == "c (d)");
    CHECK(full.hint() == "e (f)");
    const error bare(error_kind::bad_input, "what", "why");
    CHECK(bare.subject() == "what");
    CHECK(bare.why() == "why");
    CHECK(bare.hint().empty());
    const error none(error_kind::bad_input, "", "");
    CHECK(none.subject().empty());
    CHECK(none.why().empty());
}

} // namespace channel_map_test
