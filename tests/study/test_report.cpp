// SPDX-License-Identifier: MIT
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "caught.hpp"
#include "files/json/json_value.hpp"
#include "has.hpp"
#include "study/report/sections.hpp"

namespace tactor::study::test_report {
namespace {

using ordered = nlohmann::ordered_json;

const std::string file = "s.json";

study_facts sessions_that_say(const std::vector<std::string>& devices)
{
    study_facts f;
    for (const std::string& d : devices) {
        session_facts s;
        s.code = std::to_string(f.sessions.size() + 1);
        s.document = {{"device", d}};
        f.sessions.push_back(std::move(s));
    }
    return f;
}

std::string device_text(const session_facts& s)
{
    return s.facts()["device"].words();
}

TEST_CASE("values shared by all are printed once, others with their participants")
{
    CHECK(join_texts(sessions_that_say({"a", "a", "a"}), device_text) == "a");
    CHECK(join_texts(sessions_that_say({"a", "b", "a"}), device_text) == "a (sub-1, sub-3); b (sub-2)");
    CHECK(join_texts(sessions_that_say({"", "b"}), device_text) == "not recorded (sub-1); b (sub-2)");
    CHECK(join_texts(sessions_that_say({""}), device_text) == "not recorded");
}

TEST_CASE("texts from files are no Markdown, and do not control a terminal")
{
    CHECK(plain("a_b*c|d") == "a\\_b\\*c\\|d");
    CHECK(plain("two\nlines\tand") == "two lines and");
    CHECK(plain("\x1b[2J") == "\\\\x1b\\[2J");
    CHECK(plain("Größe") == "Größe");
    CHECK(table_head({"a", "b"}) == "| a | b |\n| --- | --- |\n");
}

TEST_CASE("ranges are one number where all are equal to six digits")
{
    CHECK(range_text({}) == "not recorded");
    CHECK(range_text({0.07, 0.07000000001}) == "0.07");
    CHECK(range_text({3.0, 1.5, 2.0}) == "1.5 to 3");
}

TEST_CASE("a wrong value is reported with its place")
{
    const ordered j = {{"array", {{"tactors", {{{"x_mm", "left"}}}}}}, {"n", nullptr}, {"date", 7}};
    const json_value f(j, file, "it was changed");
    CHECK_FALSE(f["n"].there());
    CHECK_FALSE(f["none"]["deeper"]["still"].there());
    CHECK(f["none"].list().empty());
    const json_value first = f["array"]["tactors"].list().at(0);
    CHECK(has(caught_message([&] { static_cast<void>(first["x_mm"].number()); }),
              "s.json: array.tactors[0].x_mm: is no number"));
    CHECK(has(caught_message([&] { static_cast<void>(first["y_mm"].need_number()); }),
              "array.tactors[0].y_mm: is missing"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"].text()); }), "date: is no text"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"]["deeper"]); }), "date: is no object"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"].list()); }), "date: is no list"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"].truth()); }),
              "date: is neither true nor false"));
}

TEST_CASE("any value has words")
{
    const ordered j = {{"a", {{"pcm", "hw:0"}, {"rate", 48000}, {"none", nullptr}}}, {"b", {1, "two"}}};
    const json_value f(j, file, "it was changed");
    CHECK(f["a"].words() == "pcm: hw:0, rate: 48000");
    CHECK(f["b"].words() == "1, two");
    CHECK(f["c"].words().empty());
}

TEST_CASE("carriers are reported as they were")
{
    const auto carrier = [](const ordered& stroke) {
        const ordered plan = {{"stroke", stroke}};
        return describe_carrier({plan, file, "it was changed"});
    };
    CHECK(carrier({{"carrier_hz", 250.0}}) == "sine of 250 Hz");
    CHECK(carrier({{"carrier_hz", 250.0}, {"waveform", "noise:100-300"}, {"noise_seed", 7}}) ==
          "noise:100-300 Hz (seed 7)");
    CHECK(carrier({{"carrier_hz", 80.0}, {"waveform", "square"}, {"am_hz", 30.0}, {"am_depth", 0.5}}) ==
          "square of 80 Hz, amplitude-modulated at 30 Hz to a depth of 0.5");
    CHECK(carrier({{"carrier_hz", 80.0},
                   {"course", {{{"t_s", 0.0}, {"hz", 80.0}}, {{"t_s", 1.0}, {"hz", 300.0}}}}}) ==
          "sine of 80 Hz, its frequency changing on the way: 80 to 300 Hz");
}

TEST_CASE("options are reported where they matter")
{
    plan_options o;
    CHECK(method_options(o) == "SOA 0.07 s, timing fixed");
    o.burst_s = 0.05;
    o.timing = timing_kind::fit;
    o.outside = outside_kind::clamp;
    CHECK(method_options(o) == "SOA 0.07 s at most, timing fit: equal SOAs that end with the path, bursts of "
                               "0.05 s instead of the law's, places outside the array moved to its edge");
    o = {};
    o.algorithm = algorithm_kind::continuous;
    CHECK(method_options(o) == "the defaults");
    o.profile.slope = 0.4;
    CHECK(method_options(o) == "$\\mathrm{SOA} = 0.4\\,d + 0.0473\\,\\mathrm{s}$ with burst duration $d$");
    CHECK(has(algorithm_text("mine"), "not one of tactor's own"));
    for (const algorithm_kind a : all_values<algorithm_kind>())
        CHECK(algorithm_text(to_string(a)) != algorithm_text("mine"));
    for (const phantom_kind p : all_values<phantom_kind>())
        CHECK(phantom_text(to_string(p)) != phantom_text("mine"));
}

} // namespace
} // namespace tactor::study::test_report
