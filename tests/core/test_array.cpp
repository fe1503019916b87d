// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
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
    array a{.name = "test"};
    for (const point p : places)
        a.tactors.push_back({.position = p, .channel = static_cast<unsigned>(a.tactors.size())});
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
    CHECK(array_presets() == std::vector<std::string>{"palm-3x3", "palm-2x4", "dualsense", "usb-7.1"});
}

TEST_CASE("presets of cards drive the channels of their card")
{
    const array grips = preset_array("dualsense");
    REQUIRE(grips.tactors.size() == 2);
    CHECK((grips.tactors[0].channel == 2 && grips.tactors[1].channel == 3 && grips.channels() == 4));
    CHECK(grips.tactors[0].position.x_mm < grips.tactors[1].position.x_mm);
    const array wide = preset_array("usb-7.1");
    const array palm = preset_array("palm-2x4");
    REQUIRE(wide.tactors.size() == 8);
    for (std::size_t i = 0; i < 8; ++i)
        CHECK((wide.tactors[i].position == palm.tactors[i].position && wide.tactors[i].channel == i));
    validate(grips);
    validate(wide);
}

TEST_CASE("an unknown preset lists the presets")
{
    CHECK(caught_message([] { return preset_array("palm-4x4"); }) ==
          "array: there is no preset 'palm-4x4' (did you mean 'palm-2x4'? presets: palm-3x3, palm-2x4, "
          "dualsense, usb-7.1)");
    CHECK(caught_message([] { return preset_array("glove"); }) ==
          "array: there is no preset 'glove' (presets: palm-3x3, palm-2x4, dualsense, usb-7.1)");
}

TEST_CASE("make_grid refuses impossible grids, and names the field")
{
    struct row {
        unsigned rows;
        unsigned columns;
        double pitch_x_mm;
        double pitch_y_mm;
        const char* field;
        const char* message;
    };
    const row all[] = {
        {0, 3, 20.0, 20.0, "rows", "grid: it has 0 rows x 3 columns (give 1 to 1024 tactors)"},
        {3, 1025, 20.0, 20.0, "columns", "grid: it has 3 rows x 1025 columns (give 1 to 1024 tactors)"},
        {33, 32, 20.0, 20.0, "",
         "grid: it has 33 rows x 32 columns (give 1 to 1024 tactors)"}, // both together
        {3, 1024, 20.0, 20.0, "", "grid: it has 3 rows x 1024 columns (give 1 to 1024 tactors)"},
        // 2^32 tactors, which is 0 in 32 bits
        {65536, 65536, 20.0, 20.0, "rows",
         "grid: it has 65536 rows x 65536 columns (give 1 to 1024 tactors)"},
        {3, 3, 0.0, 20.0, "pitch_x_mm", "grid: the pitch is 0 mm (give more than 0 mm)"},
        {3, 3, 20.0, not_a_number, "pitch_y_mm", "grid: the pitch is nan mm (give more than 0 mm)"},
        {3, 3, 20.0, -1.0, "pitch_y_mm", "grid: the pitch is -1 mm (give more than 0 mm)"},
    };
    for (const row& r : all) {
        const auto make = [&r] { return make_grid("g", r.rows, r.columns, r.pitch_x_mm, r.pitch_y_mm); };
        CHECK(caught_message(make) == r.message);
        CHECK(caught_field(make) == r.field);
    }
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
          "array 'test': tactor 2 is at (20.0000009, 0) mm, like tactor 1 (give each tactor its own place)");
    a.tactors[1].where = {"palm.toml", 5, 1};
    a.tactors[2].where = {"palm.toml", 9, 1};
    CHECK(caught_message([&] { validate(a); }) ==
          "palm.toml:9:1: tactor 2 is at (20.0000009, 0) mm, like tactor 1 (palm.toml:5:1) (give "
          "each tactor its own place)");
    a.tactors[2].position.x_mm = 20 + 1.1e-6;
    CHECK_NOTHROW(validate(a));
    a.tactors[2].channel = 1;
    CHECK(caught_message([&] { validate(a); }) == "palm.toml:9:1: tactor 2 is on channel 1, like tactor 1 "
                                                  "(palm.toml:5:1) (give each tactor its own channel)");
}

TEST_CASE("validate refuses impossible tactors, and names the field")
{
    const auto with = [](auto change) {
        array a = preset_array("palm-3x3");
        change(a.tactors[4]);
        return a;
    };
    const auto check_refused = [&](const std::string& field, const std::string& why, auto change) {
        const array a = with(change);
        CAPTURE(why);
        CHECK(caught_message([&] { validate(a); }).starts_with("array 'palm-3x3': tactor 4 " + why));
        CHECK(caught_field([&] { validate(a); }) == field);
    };
    check_refused("x_mm", "is at (nan, 20) mm", [](tactor_spec& t) { t.position.x_mm = not_a_number; });
    check_refused("y_mm", "is at (20, inf) mm", [](tactor_spec& t) { t.position.y_mm = inf; });
    check_refused("y_mm", "is at (20, 1100000) mm", [](tactor_spec& t) { t.position.y_mm = 1.1e6; });
    check_refused("channel", "is on channel 1024", [](tactor_spec& t) { t.channel = 1024; });
    check_refused("gain_db", "has a gain of 61 dB", [](tactor_spec& t) { t.gain_db = 61; });
    check_refused("gain_db", "has a gain of nan dB", [](tactor_spec& t) { t.gain_db = not_a_number; });
    check_refused("gain_db", "has a gain of -200.1 dB", [](tactor_spec& t) { t.gain_db = -200.1; });
    check_refused("max_dbfs", "has a limit of 0.1 dBFS", [](tactor_spec& t) { t.max_dbfs = 0.1; });
    check_refused("max_dbfs", "has a limit of -inf dBFS", [](tactor_spec& t) { t.max_dbfs = -inf; });
    check_refused("threshold_dbfs", "has a threshold of 3 dBFS",
                  [](tactor_spec& t) { t.threshold_dbfs = 3; });
    check_refused("thresholds", "has a threshold of 0.1 dBFS at 100 Hz", [](tactor_spec& t) {
        t.thresholds = {{100.0, 0.1}};
    });
    check_refused("thresholds", "has a threshold of -20 dBFS at 100 Hz", [](tactor_spec& t) {
        t.thresholds = {{100.0, -20.0}, {100.0, -20.0}};
    });
    check_refused("rise_s", "has a rise time of 1.001 s", [](tactor_spec& t) { t.rise_s = 1.001; });
    check_refused("rise_s", "has a rise time of 0 s", [](tactor_spec& t) { t.rise_s = 0.0; });
    check_refused("polarity", "has a polarity of 0", [](tactor_spec& t) { t.polarity = 0; });
    // The last that pass.
    for (const double db : {-200.0, 60.0})
        CHECK_NOTHROW(validate(with([db](tactor_spec& t) { t.gain_db = db; })));
    for (const double db : {-200.0, 0.0}) {
        CHECK_NOTHROW(validate(with([db](tactor_spec& t) { t.max_dbfs = db; })));
        CHECK_NOTHROW(validate(with([db](tactor_spec& t) { t.threshold_dbfs = db; })));
        CHECK_NOTHROW(validate(with([db](tactor_spec& t) { t.thresholds = {{100.0, db}}; })));
    }
    CHECK_NOTHROW(validate(with([](tactor_spec& t) { t.rise_s = 1.0; })));
    CHECK(caught_message([] { validate(array{}); }) == "array '': it has 0 tactors (give 1 to 1024)");
}

} // namespace array_test
