// SPDX-License-Identifier: MIT
// The example files and those of tactor.toml(5), as documented.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <tactor/config.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
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

TEST_CASE("strokes that are written as TOML are the same when they are read again")
{
    std::size_t tried = 0;
    for (const fs::path& f : files_in(source / "examples/strokes")) {
        if (f.extension() == ".wav")
            continue;
        CAPTURE(f.string());
        std::vector<stroke> all = load_strokes(f);
        for (stroke& s : all) {
            if (s.anchor.back != 1)
                s.anchor = {};
            if (s.sound.wave && s.sound.wave->kind == waveform_kind::recording)
                s.sound.wave.reset(); // text that is no file's may name none
        }
        const std::vector<stroke> again = parse_strokes_toml(detail::strokes_text(all), "again.toml");
        REQUIRE(again.size() == all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            const stroke& a = all[i];
            const stroke& b = again[i];
            CHECK(b.name == a.name);
            CHECK(b.start_s == a.start_s);
            if (i > 0)
                CHECK(b.anchor == a.anchor);
            CHECK(b.choices == a.choices);
            CHECK(b.fit == a.fit);
            CHECK(b.sound.carrier_hz == a.sound.carrier_hz);
            CHECK(b.sound.carrier_profile == a.sound.carrier_profile);
            CHECK(b.sound.am == a.sound.am);
            CHECK(b.motion.duration_s() == doctest::Approx(a.motion.duration_s()).epsilon(1e-12));
            for (const double part : {0.0, 0.1, 0.5, 0.77, 1.0}) {
                const double t = part * a.motion.duration_s();
                CHECK(distance_mm(b.motion.position(t), a.motion.position(t)) < 1e-6);
                CHECK(b.motion.intensity(t) == doctest::Approx(a.motion.intensity(t)).epsilon(1e-9));
            }
        }
        ++tried;
    }
    CHECK(tried >= 10);
}

TEST_CASE("a start that counts from a group is not written")
{
    stroke late{.name = "late", .start_s = 1.0, .anchor = {start_from_kind::end, 2}};
    CHECK(caught_message([&] {
              static_cast<void>(detail::strokes_text(std::vector{stroke{}, stroke{}, late}));
          }).find("group") != std::string::npos);
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
        CHECK(said == "");
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
