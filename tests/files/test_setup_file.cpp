// SPDX-License-Identifier: MIT
// Files that are missing, too long, or take their array from another file.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/setup.hpp>

#include "caught.hpp"
#include "folder.hpp"

namespace setup_file_test {

using namespace tactor;
namespace fs = std::filesystem;

namespace {

std::string complaint(const fs::path& file)
{
    return caught_message([&] { static_cast<void>(load_setup(file)); });
}

const std::string grid = "[array]\nname = \"arm\"\ngrid = { rows = 1, columns = 4, pitch_mm = 40 }\n";

} // namespace

TEST_CASE("an unreadable file is named with the reason")
{
    const folder f;
    const std::string missing = (f / "none.toml").string();
    CHECK(complaint(missing) == missing + ": No such file or directory (check the name)");
    CHECK(complaint(f / "") == (f / "").string() + ": is a folder (name a file in it)");
    CHECK(complaint(f.write("file", "") / "below").find("Not a directory") != std::string::npos);
}

TEST_CASE("an error of a file has its place and the key, as parts")
{
    const folder f;
    const auto place_and_key = [&](const fs::path& file) -> std::string {
        try {
            static_cast<void>(load_setup(file));
        } catch (const error& e) {
            return fmt::format("{}, {}, {}, {}", fs::path(e.place().file).filename().string(), e.place().line,
                               e.place().column, e.field());
        }
        return "";
    };
    CHECK(place_and_key(f / "none.toml") == "none.toml, 0, 0, ");
    CHECK(place_and_key(f.write("a.toml", "[array]\n\npich = 3\n")) == "a.toml, 3, 1, pich");
    CHECK(place_and_key(f.write("b.toml", "[output]\nrate = \"x\"\n")) == "b.toml, 2, 8, rate");
    CHECK(place_and_key(f.write("c.toml", "[output]\nrate = 1\n")) == "c.toml, 2, 8, rate");
    CHECK(place_and_key(f.write("d.toml", "[array\n")) == "d.toml, 1, 7, ");
}

TEST_CASE("a file of more than 16 MB is refused, an endless one too")
{
    const folder f;
    const fs::path full = f.write("full.toml", "#" + std::string((std::size_t{16} << 20) - 1, ' '));
    CHECK(complaint(full).empty());
    const fs::path more = f.write("more.toml", "#" + std::string(std::size_t{16} << 20, ' '));
    CHECK(complaint(more) == more.string() + ": longer than 16 MB (is it the right file?)");
    CHECK(complaint("/dev/zero") == "/dev/zero: longer than 16 MB (is it the right file?)");
}

TEST_CASE("messages name the file as it was given")
{
    const folder f;
    const fs::path bad = f.write("bad.toml", "\n\n[output]\n rat = 1\n");
    CHECK(complaint(bad) == bad.string() + ":4:2: unknown key 'rat' in [output] (did you mean 'rate'?)");
}

TEST_CASE("an array from another file, relative to the file that names it")
{
    const folder f;
    f.write("arrays/arm.toml", grid + "[output]\npcm = \"null\"\nchannels = 8\n[defaults]\nsoa = 0.06\n");
    const setup s = load_setup(f.write("tactor.toml", R"(
[array]
file = "arrays/arm.toml"
[[tactor]]
tactor = 2
threshold_dbfs = -40
[output]
channels = 10
[defaults]
speed = 70
)"));
    REQUIRE(s.array.has_value());
    CHECK(s.array->name == "arm");
    CHECK(s.array->tactors.size() == 4);
    CHECK(s.array->tactors[2].threshold_dbfs == -40.0);
    CHECK(s.array->tactors[2].where.text() == (f / "tactor.toml").string() + ":4:1");
    CHECK(s.array->tactors[1].where.text() == (f / "arrays/arm.toml").string() + ":3:8");
    // Other keys of that file hold, unless this one has them.
    CHECK(s.output.pcm == "null");
    CHECK(s.output.pcm_included);
    CHECK(s.output.pcm_at.text() == (f / "arrays/arm.toml").string() + ":5:7");
    CHECK(s.output.channels == 10u);
    CHECK(s.defaults ==
          std::vector<written_value>{{"soa", 0.06, false, {}, {}}, {"speed", 70.0, false, {}, {}}});

    f.write("arrays/palm.toml",
            grid.substr(0, 8) + "site = \"left palm\"\nup = \"fingers\"\n" + grid.substr(8));
    const setup placed =
        load_setup(f.write("placed.toml", "[array]\nfile = \"arrays/palm.toml\"\nup = \"thumb\"\n"));
    CHECK(placed.array->site == "left palm");
    CHECK(placed.array->up == "thumb");

    const setup named =
        load_setup(f.write("named.toml", "[array]\nname = \"left\"\nfile = \"arrays/arm.toml\"\n"));
    CHECK(named.array->name == "left");
}

TEST_CASE("the channel count of one file is checked against the map of another")
{
    const folder f;
    f.write("arm.toml", grid);
    const fs::path c = f.write("c.toml", "[array]\nfile = \"arm.toml\"\n[output]\nchannels = 3\n");
    CHECK(complaint(c) == fmt::format("{}:4:12: channels is 3, but tactor 3 ({}:3:8) is on channel 3 (the "
                                      "array needs 4 channels; they count from 0)",
                                      c.string(), (f / "arm.toml").string()));
}

TEST_CASE("included files that are missing, wrong, circular or without an array are refused")
{
    const folder f;
    const fs::path a = f.write("a.toml", "[array]\nfile = \"b.toml\"\n");
    const std::string at = a.string() + ":2:8: ";
    const std::string b = (f / "b.toml").string();
    CHECK(complaint(a) == at + b + ": No such file or directory (check the name)");
    f.write("b.toml", "[output]\nrate = 48000\n");
    CHECK(complaint(a) == at + b + " has no array (name an array file)");
    f.write("b.toml", "[array]\nnam = 1\n");
    CHECK(complaint(a) == b + ":2:1: unknown key 'nam' in [array] (did you mean 'name'?)");
    f.write("b.toml", "[array]\nfile = \"c/../a.toml\"\n");
    fs::create_directories(f / "c");
    CHECK(complaint(a) == fmt::format("{}:2:8: {} takes its array from itself (break the circle of files)", b,
                                      (f / "c/../a.toml").string()));
    f.write("b.toml", "[array]\nfile = \"b.toml\"\n");
    CHECK(complaint(a) == b + ":2:8: it takes its array from itself (break the circle of files)");
}

TEST_CASE("a chain of files has a limit")
{
    const folder f;
    for (int i = 0; i < 100; ++i)
        f.write(fmt::format("{}.toml", i), fmt::format("[array]\nfile = \"{}.toml\"\n", i + 1));
    f.write("100.toml", grid);
    CHECK(complaint(f / "0.toml") ==
          (f / "15.toml").string() + ":2:8: a chain of too many files (at most 16)");
    CHECK(complaint(f / "85.toml").empty());
}

} // namespace setup_file_test
