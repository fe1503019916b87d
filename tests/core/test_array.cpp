// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <climits>
#include <limits>
#include <random>
#include <string>

#include <tactor/array.hpp>

#include "caught.hpp"

namespace array_test {

using namespace tactor;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

array at_places(const std::vector<point>& places)
{
    array a;
    a.name = "test";
    for (const point p : places) {
        tactor_spec t;
        t.position = p;
        t.channel = static_cast<unsigned>(a.tactors.size());
        a.tactors.push_back(t);
    }
    return a;
}

} // namespace

TEST_CASE("palm-3x3 is the paper's array: rows from the top, 20 mm apart, channel = index")
{
    const array a = preset_array("palm-3x3");
    CHECK(a.name == "palm-3x3");
    REQUIRE(a.tactors.size() == 9);
    for (unsigned i = 0; i < 9; ++i) {
        CHECK(a.tactors[i].position == point{20.0 * (i % 3), 20.0 * (i / 3)});
        CHECK(a.tactors[i].channel == i);
        CHECK(a.tactors[i].gain_db == 0.0);
        CHECK(a.tactors[i].max_dbfs == 0.0);
        CHECK(a.tactors[i].polarity == 1);
        CHECK_FALSE(a.tactors[i].threshold_dbfs.has_value());
    }
    CHECK(a.channels() == 9);
}

TEST_CASE("palm-2x4 has two rows of four")
{
    const array a = preset_array("palm-2x4");
    REQUIRE(a.tactors.size() == 8);
    CHECK(a.tactors[3].position == point{60.0, 0.0});
    CHECK(a.tactors[4].position == point{0.0, 20.0});
    CHECK(array_presets() == std::vector<std::string>{"palm-3x3", "palm-2x4"});
}

TEST_CASE("an unknown preset lists the presets")
{
    CHECK(caught_message([] { return preset_array("palm-4x4"); }) ==
          "array: there is no preset 'palm-4x4' (did you mean 'palm-2x4'? presets: palm-3x3, palm-2x4)");
    CHECK(caught_message([] { return preset_array("glove"); }) ==
          "array: there is no preset 'glove' (presets: palm-3x3, palm-2x4)");
}

TEST_CASE("make_grid refuses impossible grids")
{
    CHECK(caught_message([] { return make_grid("g", 0, 3, 20, 20); }) ==
          "grid: 0 rows x 3 columns (1 to 1024 tactors)");
    CHECK(caught_message([] { return make_grid("g", 33, 32, 20, 20); }) ==
          "grid: 33 rows x 32 columns (1 to 1024 tactors)");
    // 2^32 tactors, which is 0 in 32 bits
    CHECK(caught_message([] { return make_grid("g", 65536, 65536, 20, 20); }) ==
          "grid: 65536 rows x 65536 columns (1 to 1024 tactors)");
    CHECK(caught_message([] { return make_grid("g", 3, 3, 0.0, 20); }) ==
          "grid: the pitch is 0 mm (it must be more than 0)");
    CHECK(caught_message([] { return make_grid("g", 3, 3, 20, not_a_number); }) ==
          "grid: the pitch is nan mm (it must be more than 0)");
    CHECK(caught_message([] { return make_grid("g", 3, 3, 20, -inf); }) ==
          "grid: the pitch is -inf mm (it must be more than 0)");
    CHECK(make_grid("g", 32, 32, 1, 1).tactors.size() == 1024);
}

TEST_CASE("channels() never wraps round to 0")
{
    array a = preset_array("palm-3x3");
    a.tactors[2].channel = UINT_MAX;
    CHECK(a.channels() == UINT_MAX);
    CHECK(array{}.channels() == 0);
}

TEST_CASE("find_grid finds any grid, in any order, moved and jittered within the tolerance")
{
    std::mt19937_64 random(1);
    std::uniform_int_distribution<unsigned> side(1, 12);
    std::uniform_real_distribution<double> gap(0.01, 30.0);
    std::uniform_real_distribution<double> jitter(-0.2e-6, 0.2e-6);
    for (int round = 0; round < 2000; ++round) {
        std::vector<double> xs{gap(random)};
        std::vector<double> ys{-gap(random)};
        while (xs.size() < side(random))
            xs.push_back(xs.back() + gap(random));
        while (ys.size() < side(random))
            ys.push_back(ys.back() + gap(random));
        std::vector<point> places;
        for (const double y : ys)
            for (const double x : xs)
                places.push_back({x + jitter(random), y + jitter(random)});
        std::shuffle(places.begin(), places.end(), random);

        const auto g = find_grid(at_places(places));
        REQUIRE(g.has_value());
        REQUIRE(g->x_mm.size() == xs.size());
        REQUIRE(g->y_mm.size() == ys.size());
        for (std::size_t i = 0; i < xs.size(); ++i)
            REQUIRE(g->x_mm[i] == doctest::Approx(xs[i]).epsilon(1e-6));
        for (std::size_t i = 0; i < ys.size(); ++i)
            REQUIRE(g->y_mm[i] == doctest::Approx(ys[i]).epsilon(1e-6));

        if (xs.size() > 1 && ys.size() > 1) {
            std::vector<point> hole(places.begin(), places.end() - 1);
            REQUIRE_FALSE(find_grid(at_places(hole)).has_value());
            std::vector<point> moved = places;
            moved.back().x_mm += 0.003;
            REQUIRE_FALSE(find_grid(at_places(moved)).has_value());
            std::vector<point> twice = places;
            twice.back() = twice.front();
            REQUIRE_FALSE(find_grid(at_places(twice)).has_value());
        }
    }
}

TEST_CASE("find_grid: nothing, one tactor, a ring")
{
    CHECK_FALSE(find_grid(array{}).has_value());
    const auto one = find_grid(at_places({{3.0, 4.0}}));
    REQUIRE(one.has_value());
    CHECK(one->x_mm == std::vector<double>{3.0});
    CHECK(one->y_mm == std::vector<double>{4.0});
    CHECK_FALSE(find_grid(at_places({{1, 0}, {0, 1}, {-1, 0}, {0, -1}})).has_value());
    CHECK_FALSE(find_grid(at_places({{not_a_number, 0}, {0, 1}})).has_value());
}

TEST_CASE("validate takes the presets and grids of the greatest size")
{
    for (const std::string& name : array_presets())
        CHECK_NOTHROW(validate(preset_array(name)));
    CHECK_NOTHROW(validate(make_grid("g", 32, 32, 2e-6, 2e-6)));
}

TEST_CASE("validate names both tactors, with their lines where known")
{
    array a = at_places({{0, 0}, {20, 0}, {20 + 0.9e-6, 0}});
    CHECK(caught_message([&] { validate(a); }) ==
          "array 'test': tactor 2 is at (20.0000009, 0) mm, the place of "
          "tactor 1 (give each tactor a place of its own)");
    a.tactors[1].where = {"palm.toml", 5, 1};
    a.tactors[2].where = {"palm.toml", 9, 1};
    CHECK(caught_message([&] { validate(a); }) ==
          "palm.toml:9:1: tactor 2 is at (20.0000009, 0) mm, the place of tactor 1 (palm.toml:5:1) (give "
          "each tactor a place of its own)");
    a.tactors[2].position.x_mm = 20 + 1.1e-6;
    CHECK_NOTHROW(validate(a));
    a.tactors[2].channel = 1;
    CHECK(caught_message([&] { validate(a); }) == "palm.toml:9:1: tactor 2 is on channel 1, that of tactor 1 "
                                                  "(palm.toml:5:1) (give each tactor a channel of its own)");
}

TEST_CASE("validate refuses impossible tactors")
{
    const auto why = [](auto change) {
        array a = preset_array("palm-3x3");
        change(a.tactors[4]);
        return caught_message([&] { validate(a); });
    };
    const std::string at = "array 'palm-3x3': tactor 4 ";
    CHECK(why([](tactor_spec& t) { t.position.x_mm = not_a_number; }).starts_with(at + "is at (nan, 20) mm"));
    CHECK(why([](tactor_spec& t) { t.position.y_mm = inf; }).starts_with(at + "is at (20, inf) mm"));
    CHECK(why([](tactor_spec& t) { t.position.y_mm = 1.1e6; }).starts_with(at + "is at (20, 1100000) mm"));
    CHECK(why([](tactor_spec& t) { t.channel = 1024; }).starts_with(at + "is on channel 1024"));
    CHECK(why([](tactor_spec& t) { t.gain_db = 61; }).starts_with(at + "has a gain of 61 dB"));
    CHECK(why([](tactor_spec& t) { t.gain_db = not_a_number; }).starts_with(at + "has a gain of nan dB"));
    CHECK(why([](tactor_spec& t) { t.max_dbfs = 0.1; }).starts_with(at + "has a limit of 0.1 dBFS"));
    CHECK(why([](tactor_spec& t) { t.max_dbfs = -inf; }).starts_with(at + "has a limit of -inf dBFS"));
    CHECK(why([](tactor_spec& t) { t.threshold_dbfs = 3; }).starts_with(at + "has a threshold of 3 dBFS"));
    CHECK(why([](tactor_spec& t) { t.polarity = 0; }).starts_with(at + "has a polarity of 0"));
    CHECK(why([](tactor_spec&) {}).empty());
    // The last that pass, and the next.
    for (const double db : {-200.0, 60.0})
        CHECK(why([db](tactor_spec& t) { t.gain_db = db; }).empty());
    CHECK(why([](tactor_spec& t) { t.gain_db = -200.1; }).starts_with(at + "has a gain of -200.1 dB"));
    for (const double db : {-200.0, 0.0}) {
        CHECK(why([db](tactor_spec& t) { t.max_dbfs = db; }).empty());
        CHECK(why([db](tactor_spec& t) { t.threshold_dbfs = db; }).empty());
        CHECK(why([db](tactor_spec& t) { t.thresholds = {{100.0, db}}; }).empty());
    }
    CHECK(why([](tactor_spec& t) {
              t.thresholds = {{100.0, 0.1}};
          }).starts_with(at + "has a threshold of 0.1 dBFS at 100 Hz"));
    CHECK(why([](tactor_spec& t) {
              t.thresholds = {{100.0, -20.0}, {100.0, -20.0}};
          }).starts_with(at + "has a threshold of -20 dBFS at 100 Hz"));
    CHECK(why([](tactor_spec& t) { t.rise_s = 1.0; }).empty());
    CHECK(why([](tactor_spec& t) { t.rise_s = 1.001; }).starts_with(at + "has a rise time of 1.001 s"));
    CHECK(why([](tactor_spec& t) { t.rise_s = 0.0; }).starts_with(at + "has a rise time of 0 s"));
    CHECK(caught_message([] { validate(array{}); }) == "array '': 0 tactors (an array has 1 to 1024)");
}

} // namespace array_test
