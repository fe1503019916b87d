// SPDX-License-Identifier: MIT
// The example files and those of tactor.toml(5), as documented.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include <tactor/config.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "files/text_file.hpp"

namespace examples_test {

using namespace tactor;
namespace fs = std::filesystem;

namespace {

const fs::path source = TACTOR_SOURCE_ROOT;

std::vector<fs::path> files_in(const fs::path& folder)
{
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(folder))
        all.push_back(entry.path());
    return all;
}

} // namespace

TEST_CASE("every example array is read and named after its file")
{
    const auto files = files_in(source / "examples/arrays");
    CHECK(files.size() >= 4);
    for (const fs::path& f : files) {
        CAPTURE(f.string());
        setup s;
        REQUIRE(caught_message([&] { s = load_setup(f); }) == "");
        REQUIRE(s.array.has_value());
        CHECK(s.array->name == f.stem().string());
    }
}

TEST_CASE("the tactors of the example ring lie on one circle")
{
    const setup s = load_setup(source / "examples/arrays/ring-8.toml");
    for (const tactor_spec& t : s.array->tactors)
        CHECK(distance_mm(t.position, {25.0, 25.0}) == doctest::Approx(25.0).epsilon(1e-9));
}

TEST_CASE("every example stroke is read")
{
    const auto files = files_in(source / "examples/strokes");
    CHECK(files.size() >= 4);
    for (const fs::path& f : files) {
        CAPTURE(f.string());
        if (f.extension() == ".wav") // a waveform of one of them
            continue;
        const std::string said = caught_message([&] { CHECK_FALSE(load_strokes(f).empty()); });
        CHECK((said.empty() || (TACTOR_HAS_RECORDINGS == 0 && said.find("libsndfile") != std::string::npos)));
    }
}

TEST_CASE("the example configuration is read")
{
    const setup s = load_setup(source / "examples/tactor.toml");
    CHECK(s.array->name == "left-hand");
    CHECK(s.amplifier.has_value());
    CHECK(s.sync->channel == 9u);
    CHECK(s.defaults.size() >= 5);
}

TEST_CASE("the examples in the manual page are read")
{
    const std::string page(std::string_view(detail::read_text_file(source / "man/tactor.toml.5", 1 << 20)));
    int arrays = 0;
    int strokes = 0;
    for (std::size_t at = 0; (at = page.find(".Bd -literal", at)) != std::string::npos;) {
        at = page.find('\n', at) + 1;
        const std::string text = page.substr(at, page.find(".Ed", at) - at);
        CAPTURE(text);
        const bool stroke_text = text.starts_with("[[stroke") || text.starts_with("t_s");
        strokes += stroke_text ? 1 : 0;
        arrays += stroke_text ? 0 : 1;
        if (text.find("file = ") != std::string::npos)
            CHECK(caught_message([&] { static_cast<void>(parse_setup(text, "man")); }).find("No such file") !=
                  std::string::npos);
        else if (stroke_text)
            CHECK(caught_message([&] { static_cast<void>(parse_strokes(text, "man")); }) == "");
        else
            CHECK(caught_message([&] { static_cast<void>(parse_setup(text, "man")); }) == "");
    }
    CHECK(arrays >= 3);
    CHECK(strokes >= 2);
}

} // namespace examples_test
