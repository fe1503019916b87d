// SPDX-License-Identifier: MIT
// Requests of OSC messages, and faults of their values.
#include "server/osc.hpp"

#include <limits>

#include <doctest/doctest.h>

#include "has.hpp"
#include "server/faults.hpp"

namespace osc_request_test {

using namespace tactor;
using namespace tactor::server;
using net::json;
using values = std::vector<net::osc_value>;

namespace {

osc_request read(const std::string& address, values v)
{
    return read_osc({.address = address, .values = std::move(v)});
}

std::string refusal(const std::string& address, values v)
{
    try {
        static_cast<void>(read(address, std::move(v)));
    } catch (const fault_error& e) {
        return net::fault_text(e.fault());
    }
    return {};
}

std::int64_t operator""_i(unsigned long long n)
{
    return static_cast<std::int64_t>(n);
}

} // namespace

TEST_CASE("each address asks for a method of the protocol")
{
    struct {
        const char* address;
        values given;
        const char* params;
        std::int32_t number;
    } const cases[] = {
        {"/tactor/play", {"park2016-1"}, R"({"stroke":"park2016-1","options":{}})", 0},
        {"/tactor/play", {7_i, " M 0 0 L 9 9"}, R"({"path":" M 0 0 L 9 9","options":{}})", 7},
        {"/tactor/play",
         {-3.0, "m 0 0 9 9", "soa=0.07", "snap=true", "algorithm=park2016", "sl=-1e1"},
         R"({"path":"m 0 0 9 9","options":{"soa":0.07,"snap":true,"algorithm":"park2016","sl":-10.0}})",
         -3},
        {"/tactor/begin", {1_i}, R"({"options":{}})", 1},
        {"/tactor/begin",
         {1_i, "timeout_s=5", "phantom=linear", "smooth_s=0.05"},
         R"({"options":{"phantom":"linear"},"smooth_s":0.05,"timeout_s":5.0})",
         1},
        {"/tactor/to", {1_i, 2_i, 3.5}, R"({"x_mm":2.0,"y_mm":3.5})", 1},
        {"/tactor/to", {1_i, 2.0, 3.5, 0.25}, R"({"x_mm":2.0,"y_mm":3.5,"intensity":0.25})", 1},
        {"/tactor/end", {2_i}, "{}", 2},
        {"/tactor/cancel", {2147483647_i}, "{}", 2147483647},
        {"/tactor/stop", {}, "{}", 0},
        {"/tactor/drive", {4_i, 1_i}, R"({"tactor":4.0,"intensity":1.0})", 0},
        {"/tactor/drive", {4_i, 0.5, 2.0}, R"({"tactor":4.0,"intensity":0.5,"duration_s":2.0})", 0},
        {"/tactor/subscribe", {"levels", "stream"}, R"({"events":["levels","stream"]})", 0},
        {"/tactor/subscribe", {}, R"({"events":[]})", 0},
    };
    for (const auto& c : cases) {
        CAPTURE(c.params);
        const osc_request r = read(c.address, c.given);
        CHECK("/tactor/" + r.method == c.address);
        CHECK(r.params == json::parse(c.params));
        CHECK(r.number == c.number);
    }
    CHECK(read("/tactor/subscribe", {9000_i, "levels"}).port == 9000);
}

TEST_CASE("stop has any values but those of a button's release; a stroke's number may be followed by any")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const values& v : {values{}, {1_i}, {-1_i}, {1.0}, {0.5}, {nan}, {""}, {"0"}, {1_i, 0_i}})
        CHECK(read("/tactor/stop", v).method == "stop");
    for (const char tag : {'T', 'N', 'I', 'b'})
        CHECK(read("/tactor/stop", {net::osc_other{tag}}).method == "stop");
    CHECK(read("/tactor/stop", {"x", net::osc_other{'F'}}).method == "stop");
    for (const values& v : {values{0_i}, {0.0}, {-0.0}, {net::osc_other{'F'}}, {0_i, 1_i}, {0.0, "x"}})
        CHECK(read("/tactor/stop", v).method.empty());
    for (const char* address : {"/tactor/cancel", "/tactor/end"})
        for (const values& v : {values{2_i, 1_i}, {2_i, 0_i}, {2.0, 1.0, "x"}, {2_i, net::osc_other{'T'}}}) {
            CHECK(read(address, v).number == 2);
            CHECK(read(address, v).params.empty());
        }
}

TEST_CASE("whole numbers are numbers of a stroke, whatever type a pad gives them")
{
    for (const values& v : {values{2_i, 20_i, 10_i}, {2.0, 20.0, 10.0}, {2.0, 20_i, 10.0}}) {
        const osc_request r = read("/tactor/to", v);
        CHECK(r.number == 2);
        CHECK(r.params == json{{"x_mm", 20.0}, {"y_mm", 10.0}});
    }
}

TEST_CASE("wrong values are refused by their names")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    struct {
        const char* address;
        values given;
        const char* says;
    } const cases[] = {
        {"/tactor/play", {}, "stroke: it is missing"},
        {"/tactor/play", {1_i}, "stroke: it is missing"},
        {"/tactor/play", {1_i, 2_i}, "stroke: it is not a text"},
        {"/tactor/play", {1.5, "x"}, "number: 1.5 is not a whole number"},
        {"/tactor/play", {2147483648_i, "x"}, "number: 2147483648 is not a whole number"},
        {"/tactor/play", {net::osc_other{'N'}, "x"}, "stroke: it is not a text"},
        {"/tactor/play", {"x", 1_i}, "options: it is not a text"},
        {"/tactor/play", {"x", "soa"}, "\"soa\" is not an option"},
        {"/tactor/play", {"x", "=1"}, "\"=1\" is not an option"},
        {"/tactor/play", {"x", "soa=1", "soa=2"}, "options.soa: it occurs twice"},
        {"/tactor/begin", {}, "number: it is missing"},
        {"/tactor/begin", {0_i}, "number: 0 means no number"},
        {"/tactor/begin", {"1"}, "number: it is not a number"},
        {"/tactor/to", {1_i, 2_i}, "y_mm: it is missing"},
        {"/tactor/to", {1_i, nan, 0_i}, "x_mm: it is not finite"},
        {"/tactor/to", {1_i, 0_i, std::numeric_limits<double>::infinity()}, "y_mm: it is not finite"},
        {"/tactor/to", {1_i, net::osc_other{'b'}, 0_i}, "x_mm: it is not a number"},
        {"/tactor/to", {1_i, 0_i, 0_i, "loud"}, "intensity: it is not a number"},
        {"/tactor/to", {1_i, 0_i, 0_i, 1_i, 1_i}, "values: there are 5, but only 4 are allowed"},
        {"/tactor/end", {}, "number: it is missing"},
        {"/tactor/cancel", {nan}, "number: it is not finite"},
        {"/tactor/drive", {1_i}, "intensity: it is missing"},
        {"/tactor/subscribe", {0_i, "levels"}, "port: 0 is not a whole number"},
        {"/tactor/subscribe", {65536_i, "levels"}, "port: 65536 is not a whole number"},
        {"/tactor/subscribe", {"strokes"}, "\"strokes\" is unknown"},
        {"/tactor", {}, "address: it is unknown"},
        {"/tactor/", {}, "address: it is unknown"},
        {"/tactor/st*p", {}, "address: it is unknown"},
        {"/tactor/hello", {}, "address: it is unknown"},
        // A pad sends its place alone, in parts of its size or in mm; others misspell, or send texts.
        {"/tactor/to",
         {0.25, 0.75},
         "number: 0.25 is not a whole number from -2147483648 to 2147483647 (the stroke's number comes "
         "first: /tactor/begin 1, then /tactor/to 1 X Y in mm)"},
        {"/tactor/to", {20.0, 10.0}, "y_mm: it is missing (the stroke's number comes first: "},
        {"/tactor/to",
         {"1", 20.0, 10.0},
         "number: it is not a number (send it as i, h, f or d, not as a text)"},
        {"/tactor/beginn",
         {1_i},
         "address: it is unknown (did you mean /tactor/begin? use /tactor/ with play, "},
        {"/2/play", {1_i}, "did you mean /tactor/play? "},
    };
    for (const auto& c : cases)
        CHECK_MESSAGE(has(refusal(c.address, c.given), c.says), c.address);
}

} // namespace osc_request_test
