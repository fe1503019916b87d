// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace presets_test {

using tactor::point;

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
        return caught_message([name] { static_cast<void>(tactor::preset_stroke(name)); });
    };
    CHECK(said("circle") == "stroke: no preset 'circle' (" + all);
    CHECK(said("prak2016-1") == "stroke: no preset 'prak2016-1' (did you mean 'park2016-1'? " + all);
    CHECK(said("round2x4") == "stroke: no preset 'round2x4' (did you mean 'round-2x4'? " + all);
}

} // namespace presets_test
