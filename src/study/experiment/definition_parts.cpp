// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/kind_names.hpp"
#include "files/toml_reader.hpp"

namespace tactor::study {
namespace {

using detail::bounds;
using detail::toml_table;

constexpr bounds positive_time{0.0, 3600.0, true};
constexpr bounds positive_speed{0.0, 100000.0, true};

// A key may have its unit behind it, as in stroke files, or not, as options do.
std::string_view spelled(const toml_table& t, std::string_view plain, std::string_view with_unit)
{
    if (t.has(plain) && t.has(with_unit))
        t.fail(with_unit, fmt::format("{} has both {} and {}", t.title(), plain, with_unit),
               "keep one of them");
    return t.has(with_unit) ? with_unit : plain;
}

// What the library refuses, with the place in the definition.
template <class F>
auto at_key(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        throw error(e.kind(), t.where(key), fmt::format("{}: {}", e.subject(), e.why()), e.hint())
            .with_field(key);
    }
}

stroke read_file_stroke(const toml_table& t, const std::filesystem::path& folder)
{
    std::vector<stroke> all =
        at_key(t, "file", [&] { return load_strokes(folder / *t.text("file")); }); // relative, or not
    if (all.size() != 1)
        t.fail("file", fmt::format("there are {} strokes in it", all.size()), "a motion is one stroke");
    return std::move(all.front());
}

stroke along_path(const toml_table& t, std::optional<double> duration_s, std::optional<double> speed_mm_s)
{
    return at_key(t, "path", [&] {
        const path way = path::from_svg(*t.text("path"));
        const double usual_s = way.length_mm() / speed_mm_s.value_or(default_speed_mm_s);
        return stroke{"path", trajectory::along(way, duration_s.value_or(usual_s)), {}, {}, {}};
    });
}

template <class Enum>
void read_kind(const toml_table& t, std::string_view key, Enum& into)
{
    const auto text = t.text(key);
    if (!text)
        return;
    const auto e = detail::kind_named<Enum>(*text);
    if (!e)
        t.fail(key, fmt::format("{} is {}", key, detail::shown(*t.node(key))),
               fmt::format("one of {}", fmt::join(detail::names_of<Enum>(), ", ")));
    into = *e;
}

void read_law(const toml_table& t, plan_options& o)
{
    const auto slope = t.number("slope", {0.01, 0.99});
    const auto intercept = t.number(spelled(t, "intercept", "intercept_s"), {0.001, 10.0});
    if (!slope && !intercept)
        return;
    o.profile.slope = slope.value_or(o.profile.slope);
    o.profile.intercept_s = intercept.value_or(o.profile.intercept_s);
    o.profile.max_soa_s = o.profile.intercept_s / (1.0 - o.profile.slope);
}

} // namespace

std::string name_in(const toml_table& t, std::string_view key)
{
    std::string text = t.need(t.text(key), key);
    const bool controls =
        std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    if (controls || text == "n/a" || text.front() == ' ' || text.back() == ' ')
        t.fail(key, fmt::format("{} is no such name: {}", detail::shown(*t.node(key)), t.title()),
               "any but n/a, on one line, without tabs, not in blanks");
    return text;
}

motion_definition read_motion(const toml_table& t, const std::filesystem::path& folder)
{
    t.only({"name", "preset", "path", "file", "duration", "duration_s", "speed", "speed_mm_s"});
    const std::string_view kind = t.one_of({"preset", "path", "file"});
    const std::string_view duration_key = spelled(t, "duration", "duration_s");
    const std::string_view speed_key = spelled(t, "speed", "speed_mm_s");
    const auto duration = t.number(duration_key, positive_time);
    const auto speed = t.number(speed_key, positive_speed);
    if (duration && speed)
        t.fail(speed_key, fmt::format("{} has both {} and {}", t.title(), duration_key, speed_key),
               "keep one of them");
    stroke drawn = kind == "file"   ? read_file_stroke(t, folder)
                   : kind == "path" ? along_path(t, duration, speed)
                                    : at_key(t, "preset", [&] { return preset_stroke(*t.text("preset")); });
    if (duration)
        drawn.motion = at_key(t, duration_key, [&] { return drawn.motion.with_duration(*duration); });
    else if (speed && drawn.motion.length_mm() > 0.0)
        drawn.motion = at_key(t, speed_key, [&] { return drawn.motion.with_speed(*speed); });
    drawn.start_s.reset();                                // it is played alone
    drawn.choices = {.level_db = drawn.choices.level_db}; // methods choose the rest
    return {name_in(t, "name"), std::move(drawn), t.where()};
}

method_definition read_method(const toml_table& t)
{
    t.only({"name", "algorithm", "phantom", "faces", "soa", "soa_s", "burst", "burst_s", "slope", "intercept",
            "intercept_s", "timing", "outside", "snap", "drop-points", "drop_points", "overlap", "carrier",
            "carrier_hz"});
    method_definition m{name_in(t, "name"), {}, t.where()};
    plan_options& o = m.options;
    read_kind(t, "algorithm", o.algorithm);
    read_kind(t, "phantom", o.phantom);
    read_kind(t, "faces", o.faces);
    read_kind(t, "timing", o.timing);
    read_kind(t, "outside", o.outside);
    read_kind(t, "overlap", o.overlap);
    o.soa_s = t.number(spelled(t, "soa", "soa_s"), {0.0, 10.0, true}).value_or(o.soa_s);
    if (const auto burst = t.number(spelled(t, "burst", "burst_s"), {0.0001, 10.0}))
        o.burst_s = burst;
    read_law(t, o);
    o.snap = t.boolean("snap").value_or(false);
    o.drop_points = t.boolean(spelled(t, "drop-points", "drop_points")).value_or(false);
    o.carrier_hz = t.number(spelled(t, "carrier", "carrier_hz"), {1.0, 384000.0}).value_or(o.carrier_hz);
    return m;
}

} // namespace tactor::study
