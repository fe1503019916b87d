// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <set>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "caught.hpp"
#include "core/marks.hpp"
#include "options/option.hpp"
#include "options/settle.hpp"

namespace table_test {

using namespace tactor;
using namespace tactor::options;

namespace {

bool is_number(const option& o)
{
    return o.what == kind::number || o.what == kind::whole;
}

wishes with(std::uint64_t place, std::initializer_list<std::pair<const char*, value>> given)
{
    wishes w;
    w.place = place;
    for (const auto& [name, v] : given)
        give(w, *find(name), v);
    return w;
}

std::string bracketed(const option& o, std::string_view value)
{
    return fmt::format("<{}{}{}>", o.name, value.empty() ? "" : ":", value);
}

std::string speech(std::string_view text)
{
    return spell(text, {bracketed});
}

} // namespace

TEST_CASE("each row has all its fields")
{
    std::set<std::string_view> names;
    for (const option& o : all()) {
        CAPTURE(o.name);
        CHECK(names.insert(o.name).second);
        CHECK(find(o.name) == &o);
        CHECK(find(o.field_name()) == &o);
        CHECK_FALSE(o.help.empty());
        CHECK(o.where != 0);
        CHECK((o.to.set != nullptr && o.to.get != nullptr));
        CHECK((o.what == kind::choice) <= (o.choices != nullptr));
        CHECK(is_number(o) <= (o.allowed.low < o.allowed.high));
        CHECK((o.used == nullptr) == o.needs.empty());
        if (!o.rival.empty()) {
            REQUIRE(find(o.rival) != nullptr);
            CHECK(find(o.rival)->rival == o.name);
        }
        // Marks name rows.
        CHECK(speech(o.needs).find('{') == std::string::npos);
        CHECK(speech(o.range).find('{') == std::string::npos);
    }
}

TEST_CASE("each number ends at its bounds, typed and as a value, and comes back")
{
    for (const option& o : all()) {
        if (!is_number(o))
            continue;
        CAPTURE(o.name);
        for (const double v : {o.allowed.low, o.allowed.high}) {
            wishes w;
            put(w, o, read_value(o, v));
            CHECK(std::get<double>(o.to.get(w)) == v);
            CHECK(std::get<double>(read_text(o, fmt::format("{}", v))) == v);
        }
        const double below = std::nextafter(o.allowed.low, -1e300);
        const double above = std::nextafter(o.allowed.high, 1e300);
        for (const double v : {below, above, std::nan(""), double(INFINITY)}) {
            const std::string said = caught_message([&] { static_cast<void>(read_value(o, v)); });
            CHECK(said.starts_with(fmt::format("{}: ", o.name)));
            CHECK(said.find(" is out of range (" + sign_hint(o.allowed, v) + detail::plain(range_text(o)) +
                            ")") != std::string::npos);
            CHECK_THROWS_AS(read_text(o, fmt::format("{}", v)), error);
        }
        if (o.what == kind::whole)
            CHECK_THROWS_AS(read_value(o, o.allowed.low + 0.5), error);
        CHECK_THROWS_AS(read_value(o, true), error);
        CHECK_THROWS_AS(read_value(o, "1"), error);
        CHECK_THROWS_AS(read_value(o, value()), error);
    }
}

TEST_CASE("each choice and flag comes back, and no other word is accepted")
{
    for (const option& o : all()) {
        CAPTURE(o.name);
        if (o.what == kind::choice)
            for (const std::string_view name : o.choices()) {
                wishes w;
                put(w, o, read_text(o, std::string(name)));
                CHECK(std::get<std::string>(o.to.get(w)) == name);
            }
        if (o.what == kind::flag) {
            wishes w;
            put(w, o, read_text(o, "true"));
            CHECK(std::get<bool>(o.to.get(w)));
        }
        if (o.what == kind::choice || o.what == kind::flag) {
            CHECK_THROWS_AS(read_text(o, "nonsense"), error);
            CHECK_THROWS_AS(read_value(o, 1.0), error);
        }
    }
}

TEST_CASE("two exclusive options are refused in any order")
{
    for (const option& o : all()) {
        if (o.rival.empty())
            continue;
        CAPTURE(o.name);
        wishes w;
        give(w, *find(o.rival), find(o.rival)->allowed.low);
        CHECK(caught_message([&] { give(w, o, o.allowed.low); }) ==
              fmt::format("{}: there is also {{{}}} (give one of them)", o.name, o.rival));
    }
}

TEST_CASE("an unused option is refused with a hint for its place")
{
    const auto said = [](std::uint64_t place, std::initializer_list<std::pair<const char*, value>> given) {
        wishes w = with(place, given);
        return caught_message([&] { settle(w); });
    };
    CHECK(said(on_plan, {{"sigma_mm", 3.0}}) ==
          "sigma_mm: nothing here uses it (add compensate = low-speed)");
    CHECK(said(on_compare, {{"sigma_mm", 3.0}}) ==
          "sigma_mm: nothing here uses it (add observer = low-speed or compensate = low-speed)");
    CHECK(said(on_plan, {{"sigma_mm", 3.0}, {"compensate", "low-speed"}}) == "");
    CHECK(said(by_client, {{"stevens_exponent", 0.9}}) ==
          "stevens_exponent: nothing here uses it (add intensity_scale = stevens)");
    CHECK(said(by_client, {{"ramp", 0.1}, {"envelope", "tukey"}}) ==
          "ramp: {envelope=tukey} has its own ramps (leave one of them out)");
    CHECK(said(on_plan, {{"intensity_scale", "sl"}}) ==
          "intensity_scale: sl is a part of a sensation level above 0 dB (add sl, such as sl = 7)");
    CHECK(said(on_plan, {{"fit_margin", 1.0}}) == "fit_margin: nothing here uses it (add fit_strokes())");
}

TEST_CASE("a user's timing law has its own longest SOA")
{
    wishes w = with(on_plan, {{"slope", 0.3}, {"intercept", 0.04}});
    settle(w);
    CHECK(w.plan.profile.max_soa_s == doctest::Approx(0.04 / 0.7));
    wishes usual = with(on_plan, {{"soa", 0.06}});
    settle(usual);
    CHECK(usual.plan.profile.max_soa_s == 0.07);
}

TEST_CASE("marks are spelled, other braces stay")
{
    CHECK(speech("use {timing=fit} or {soa_s}, {nothing} { x }") ==
          "use <timing:fit> or <soa>, {nothing} { x }");
    CHECK(speech("{") == "{");
    CHECK(speech("") == "");
}

TEST_CASE("a front end uses its own words, and leaves out what it lacks")
{
    constexpr std::array own{own_word{"fit=true", ""}, own_word{"array", "<array:{}>"},
                             own_word{"at_ns", "<at>"}};
    const spelling client{bracketed, by_client, own};
    CHECK(spell("{array=a b| is another, }{fit=true| scales it, }or {outside=clamp}", client) ==
          "<array:a b> is another, or <outside:clamp>");
    CHECK(spell("lower {max_drive_s} or {soa}", client) == "lower max_drive_s or <soa>"); // no client has it
    CHECK(spell("{command:devices} lists all", client) == "tactor devices lists all");
    CHECK(spell("{soa_s}, {sl_db}, {phantom=log}", client, true) == "soa_s, <sl>, phantom = log");
    CHECK(spell_field("at_ns", client) == "<at>");
    CHECK(spell_field("soa_s", client) == "<soa>");
    CHECK(spell_field("gain_db", client) == "gain_db");
    CHECK(spell_field("", client).empty());
}

TEST_CASE("an error about a field names the option, unless it is about a key of a file")
{
    const auto said = [](const error& e) {
        const error once = spell(e, {bracketed});
        CHECK(std::string(spell(once, {bracketed}).what()) == once.what());
        return std::string(once.what());
    };
    const auto about = [](const char* what) { return error(error_kind::bad_input, what, "no", "{soa_s}"); };
    CHECK(said(about("soa_s").with_field("soa_s")) == "<soa>: no (<soa>)");
    CHECK(said(about("{timing=fit}").with_field("min_duration_s")) == "<timing:fit>: no (<soa>)");
    CHECK(said(about("path")) == "path: no (<soa>)"); // not the option
    CHECK(said(about("soa_s.toml")) == "soa_s.toml: no (<soa>)");
    CHECK(said(error(error_kind::bad_input, source_place{"s.toml", 3, 1}, "no", "{soa_s} or {sl_db}")
                   .with_field("soa_s")) == "s.toml:3:1: no (soa_s or <sl>)");
}

TEST_CASE("options of planning are refused beside a plan")
{
    for (const option& o : all()) {
        wishes w;
        w.given.set(index(o));
        CAPTURE(o.name);
        const bool refused = !caught_message([&] { refuse_planning(w, "p.json"); }).empty();
        CHECK(refused == ((o.where & planning) != 0));
    }
}

} // namespace table_test
