// SPDX-License-Identifier: MIT
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "caught.hpp"
#include "files/json/json_value.hpp"
#include "has.hpp"
#include "options/resolve.hpp"
#include "study/report/report.hpp"

namespace tactor::study::test_report {
namespace {

using ordered = nlohmann::ordered_json;

const std::string file = "s.json";

// Facts of sessions whose only one is a device.
ordered sessions_that_say(const std::vector<std::string>& devices)
{
    ordered sessions = ordered::array();
    for (const std::string& d : devices)
        sessions.push_back({{"code", std::to_string(sessions.size() + 1)}, {"device", d}});
    return {{"sessions", sessions}, {"each", sessions}, {"alike", sessions}};
}

std::string fill_in_devices(const std::vector<std::string>& devices)
{
    return fill_in("[[#each]] [[device]], [[/each]]", sessions_that_say(devices));
}

TEST_CASE("values shared by all are printed once, others with their participants")
{
    CHECK(fill_in_devices({"a", "a", "a"}) == "a");
    CHECK(fill_in_devices({"a", "b", "a"}) == "a (sub-1, sub-3); b (sub-2)");
    CHECK(fill_in_devices({"", "b"}) == "not recorded (sub-1); b (sub-2)");
    CHECK(fill_in_devices({""}) == "not recorded");
    CHECK(fill_in_devices({}) == "not recorded");
    CHECK(fill_in_devices({"a_b"}) == "a\\_b");
}

TEST_CASE("sections that are alike come once, with their participants, and facts that are missing are named")
{
    ordered facts = sessions_that_say({"a", "b", "a"});
    const char* const alike = "[[#alike]]\n[[who]]: [[device]]\n[[/alike]]";
    CHECK(fill_in(alike, facts) == "sub-1, sub-3: a\nsub-2: b\n");
    CHECK(fill_in(alike, sessions_that_say({"a", "a"})) == "all: a\n");
    facts["sessions"][1]["code"] = "2_ses-1";
    facts["each"][1] = ordered::object();
    CHECK(fill_in("[[#each]]by [[device]][[/each]]", facts) ==
          "by a (sub-1, sub-3); not recorded (sub-2\\_ses-1)");
}

TEST_CASE("texts from files are no Markdown, and do not control a terminal")
{
    CHECK(escape_markdown("a_b*c|d") == "a\\_b\\*c\\|d");
    CHECK(escape_markdown("two\n  lines\tand") == "two lines and");
    CHECK(escape_markdown("\x1b[2J") == "\\\\x1b\\[2J");
    CHECK(escape_markdown("Größe") == "Größe");
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
    CHECK_FALSE(f["n"].exists());
    CHECK_FALSE(f["none"]["deeper"]["still"].exists());
    CHECK(f["none"].list().empty());
    const json_value first = f["array"]["tactors"].list().at(0);
    CHECK(has(caught_message([&] { static_cast<void>(first["x_mm"].number()); }),
              "s.json: array.tactors[0].x_mm: it is not a number"));
    CHECK(has(caught_message([&] { static_cast<void>(first["y_mm"].need_number()); }),
              "array.tactors[0].y_mm: it is missing"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"].text()); }), "date: it is not a text"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"]["deeper"]); }), "date: it is not an object"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"].list()); }), "date: it is not a list"));
    CHECK(has(caught_message([&] { static_cast<void>(f["date"].truth()); }),
              "date: it is neither true nor false"));
}

TEST_CASE("any value has words")
{
    const ordered j = {{"a", {{"pcm", "hw:0"}, {"rate", 48000}, {"none", nullptr}}}, {"b", {1, "two"}}};
    const json_value f(j, file, "it was changed");
    CHECK(f["a"].words() == "pcm: hw:0, rate: 48000");
    CHECK(f["b"].words() == "1, two");
    CHECK(f["c"].words().empty());
}

TEST_CASE("options of a method are reported by their names, where they are used")
{
    options::option_values o;
    CHECK(method_options(o) ==
          "outside error, algorithm park2016, phantom inverse-distance, faces delaunay, soa 0.07, "
          "slope 0.32, intercept 0.0473, timing fixed, overlap energy, carrier 250");
    o.plan.burst_s = 0.05;
    o.plan.snap = true;
    CHECK(has(method_options(o), "soa 0.07, burst 0.05, slope"));
    CHECK(has(method_options(o), ", snap"));
    const auto give = [&o](const char* name, const options::value& v) {
        options::give(o, *options::find(name), v);
    };
    give("waveform", std::string("noise:50-500"));
    give("noise_seed", 3.0);
    give("envelope", std::string("linear"));
    give("level_dbfs", -20.0);
    CHECK(has(method_options(o),
              "carrier 250, waveform noise:50-500, noise_seed 3, envelope linear, level_dbfs -20"));
}

TEST_CASE("the template has a section for each algorithm and phantom model")
{
    for (const algorithm_kind a : all_values<algorithm_kind>())
        CHECK(has(std::string(methods_template()),
                  fmt::format("[[#equations.{}]]\n**Algorithm", to_string(a))));
    for (const phantom_kind p : all_values<phantom_kind>())
        CHECK(has(std::string(methods_template()),
                  fmt::format("[[#equations.{}]]\n**Phantom model", to_string(p))));
}

TEST_CASE("the name of a model of one's own takes no fact's place")
{
    for (const char* name : {"title", "participants", "sessions", "level"}) {
        CAPTURE(name);
        study_facts f;
        f.sessions.emplace_back().document = ordered::object();
        f.sessions[0].stimuli.push_back(
            {"east", "mine", "hash", file, {{"algorithm", name}, {"phantom", name}}});
        const ordered facts = collect_facts(f, {{"strokes"}}, {"strokes"});
        CHECK(facts["sessions"][0]["title"] == "strokes");
        CHECK(facts["participants"].is_string());
        CHECK(facts["sessions"].size() == 1);
        CHECK_FALSE(facts.contains("level"));
        CHECK(facts["equations"][name] == true);
    }
}

} // namespace
} // namespace tactor::study::test_report
