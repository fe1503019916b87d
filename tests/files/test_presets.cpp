// SPDX-License-Identifier: MIT
// Presets, and the example files.
#include <algorithm>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/config.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
#include "files/text_file.hpp"
#include "has.hpp"

namespace presets_test {

using tactor::point;
using namespace tactor;

TEST_CASE("the four motions of the paper, y down")
{
    struct motion {
        const char* name;
        double duration_s;
        std::vector<point> quarters; ///< where it is every 0.7 s
    };
    const motion motions[] = {
        {"park2016-1", 1.4, {{20, 4}, {4, 20}, {20, 36}}},
        {"park2016-2", 1.4, {{0, 4}, {16, 20}, {0, 36}}},
        {"park2016-3", 2.1, {{20, 36}, {4, 20}, {20, 4}, {36, 20}}},
        {"park2016-4", 2.1, {{36, 20}, {20, 4}, {4, 20}, {20, 36}}},
    };
    REQUIRE(tactor::stroke_presets().size() == 6);
    for (std::size_t i = 0; i < 4; ++i) {
        const motion& m = motions[i];
        CAPTURE(m.name);
        CHECK(tactor::stroke_presets()[i] == m.name);
        const tactor::stroke s = tactor::preset_stroke(m.name);
        CHECK(s.name == m.name);
        CHECK(s.note == tactor::note_kind::reconstructed);
        CHECK_FALSE(s.start_s.has_value());
        CHECK_FALSE(s.sound.carrier_hz.has_value());
        CHECK(s.motion.duration_s() == doctest::Approx(m.duration_s).epsilon(1e-15));
        const auto turns = static_cast<double>(m.quarters.size() - 1);
        CHECK(s.motion.length_mm() == doctest::Approx(8.0 * std::numbers::pi * turns).epsilon(1e-14));
        for (std::size_t k = 0; k < m.quarters.size(); ++k) {
            const point p = s.motion.position(m.duration_s * static_cast<double>(k) / turns);
            CAPTURE(k);
            CHECK(tactor::distance_mm(p, m.quarters[k]) < 1e-9);
        }
        CHECK(s.motion.position(0.0) == m.quarters.front());
        CHECK(s.motion.position(s.motion.duration_s()) == m.quarters.back());
        CHECK(s.motion.intensity(0.5) == 1.0);
    }
}

TEST_CASE("two motions for palm-2x4 stay on it and use all of it")
{
    const tactor::stroke wave = tactor::preset_stroke("wave-2x4");
    CHECK(wave.motion.position(0.0) == point{0, 10});
    CHECK(tactor::distance_mm(wave.motion.position(wave.motion.duration_s()), {60, 10}) < 1e-9);
    const tactor::stroke round = tactor::preset_stroke("round-2x4");
    CHECK(tactor::distance_mm(round.motion.position(0.0), {58, 10}) < 1e-9);
    CHECK(tactor::distance_mm(round.motion.position(round.motion.duration_s()), {58, 10}) < 1e-9);
    CHECK(round.motion.position(0.1).y_mm > 10.0); // clockwise: down first
    for (const tactor::stroke& s : {wave, round}) {
        CAPTURE(s.name);
        CHECK(s.note == tactor::note_kind::none);
        point low{60, 20};
        point high{0, 0};
        for (double t = 0.0; t <= s.motion.duration_s(); t += 0.001) {
            const point p = s.motion.position(t);
            low = {std::min(low.x_mm, p.x_mm), std::min(low.y_mm, p.y_mm)};
            high = {std::max(high.x_mm, p.x_mm), std::max(high.y_mm, p.y_mm)};
        }
        CHECK((low.x_mm >= 0.0 && low.x_mm <= 2.01));
        CHECK((low.y_mm >= 0.0 && low.y_mm <= 2.01));
        CHECK((high.x_mm <= 60.0 && high.x_mm >= 57.9));
        CHECK((high.y_mm <= 20.0 && high.y_mm >= 17.99));
    }
}

TEST_CASE("an unknown preset is refused with the list, and a slip with its nearest")
{
    const std::string all = "presets: park2016-1, park2016-2, park2016-3, park2016-4, wave-2x4, round-2x4)";
    const auto said = [](const char* name) {
        return caught_message([name] { return tactor::preset_stroke(name); });
    };
    CHECK(said("circle") == "stroke: there is no preset 'circle' (" + all);
    CHECK(said("prak2016-1") == "stroke: there is no preset 'prak2016-1' (did you mean 'park2016-1'? " + all);
    CHECK(said("park2016_3") == "stroke: there is no preset 'park2016_3' (did you mean 'park2016-3'? " + all);
    CHECK(said("Park2016 4") == "stroke: there is no preset 'Park2016 4' (did you mean 'park2016-4'? " + all);
    CHECK(said("round2x4") == "stroke: there is no preset 'round2x4' (did you mean 'round-2x4'? " + all);
}

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
        if (f.extension() == ".wav" || f.extension() == ".tact") // its places are parts of an array
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
    has(caught_message([&] { return detail::strokes_text(std::vector{stroke{}, stroke{}, late}); }), "group");
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
            has(caught_message([&] { return parse_setup(text, "man"); }), "No such file");
        else if (stroke_text)
            CHECK(caught_message([&] { return parse_strokes(text, "man"); }) == "");
        else
            CHECK(caught_message([&] { return parse_setup(text, "man"); }) == "");
    }
    CHECK(arrays >= 3);
    CHECK(strokes >= 2);
}

} // namespace presets_test
