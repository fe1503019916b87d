// SPDX-License-Identifier: MIT
// Stroke files in TOML: [stroke] or [[stroke]].
#include <utility>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "model/stroke_text.hpp"
#include "model/toml_reader.hpp"
#include "model/trajectory_limits.hpp"

namespace tactor {
namespace {

using detail::bounds;
using detail::max_mm;
using detail::toml_table;

constexpr double day_s = detail::longest_stroke_s;
constexpr bounds positive_time{0.0, day_s, true};
constexpr bounds anywhere{-max_mm, max_mm};

// What geometry refuses, with the place in the file.
template <class F>
auto at_key(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        t.fail(key, e.what(), {});
    }
}

path read_points(const toml_table& t)
{
    std::vector<point> points;
    std::vector<double> xy;
    const toml::array& list = *t.list("points", "[x, y]");
    points.reserve(list.size());
    for (const toml::node& entry : list) {
        t.numbers(entry, "a point", 2, 2, xy);
        points.push_back({xy[0], xy[1]});
    }
    return at_key(t, "points", [&] { return path::polyline(points); });
}

path read_arc(const toml_table& t)
{
    const toml_table a = *t.table("arc", "arc", "arc = { centre, radius_mm, from_deg, sweep_deg }");
    a.only({"centre", "radius_mm", "from_deg", "sweep_deg"});
    const point centre = a.need(a.place("centre"), "centre");
    const double radius = a.need(a.number("radius_mm", {0.0, max_mm, true}), "radius_mm");
    const double from = a.need(a.number("from_deg", {-3600.0, 3600.0}), "from_deg");
    const double sweep = a.need(a.number("sweep_deg", {-360.0, 360.0}), "sweep_deg");
    return at_key(t, "arc", [&] { return path::arc(centre, radius, from, sweep); });
}

timed_point read_timed_point(const toml_table& t, const toml::node& entry, double intensity)
{
    const toml::array* a = entry.as_array();
    if (!a || a->size() < 3 || a->size() > 4)
        detail::fail_at(t.where(entry), fmt::format("a timed point is {}", detail::shown(entry)),
                        "give [t_s, x_mm, y_mm] or [t_s, x_mm, y_mm, intensity]");
    timed_point p;
    p.t_s = t.number_of((*a)[0], "t_s", {0.0, day_s});
    p.position = {t.number_of((*a)[1], "x_mm", anywhere), t.number_of((*a)[2], "y_mm", anywhere)};
    p.intensity =
        intensity * (a->size() == 4 ? t.number_of((*a)[3], "intensity", {0.0, detail::max_intensity}) : 1.0);
    return p;
}

trajectory read_timed(const toml_table& t, double intensity)
{
    std::vector<timed_point> points;
    const toml::array& list = *t.list("timed", "[t_s, x_mm, y_mm]");
    points.reserve(list.size());
    for (const toml::node& entry : list) {
        const timed_point p = read_timed_point(t, entry, intensity);
        if (points.empty() && p.t_s != 0.0)
            detail::fail_at(t.where(entry), fmt::format("the first time is {} s", p.t_s),
                            "times count from 0 at the start of the stroke; start_s moves all of it");
        if (!points.empty() && p.t_s <= points.back().t_s)
            detail::fail_at(t.where(entry),
                            fmt::format("the time {} s does not come after {} s", p.t_s, points.back().t_s),
                            "put the points in order of time, each time once");
        points.push_back(p);
    }
    return at_key(t, "timed", [&] { return trajectory::timed(std::move(points)); });
}

struct pace {
    std::optional<double> duration_s;
    std::optional<double> speed_mm_s;

    // Seconds for a way, if the file says.
    std::optional<double> time_for(double length_mm) const
    {
        return speed_mm_s ? length_mm / *speed_mm_s : duration_s;
    }
};

pace read_pace(const toml_table& t)
{
    const pace p{t.number("duration_s", positive_time), t.number("speed_mm_s", {0.0, max_mm, true})};
    if (p.duration_s && p.speed_mm_s)
        t.fail("speed_mm_s", fmt::format("{} has both duration_s and speed_mm_s", t.title()),
               "keep one of them");
    return p;
}

// A movement that has its own time, in the time that the file asks for.
trajectory paced(const toml_table& t, const pace& p, trajectory own)
{
    const auto seconds = p.time_for(own.length_mm());
    if (!seconds)
        return own;
    const char* key = p.speed_mm_s ? "speed_mm_s" : "duration_s";
    return at_key(t, key, [&] { return own.with_duration(*seconds); });
}

stroke read_stroke(const toml_table& t, std::string name)
{
    t.only({"name", "path", "points", "timed", "arc", "preset", "duration_s", "speed_mm_s", "intensity",
            "carrier_hz", "start_s"});
    const std::string_view kind = t.one_of({"path", "points", "timed", "arc", "preset"});
    const pace asked = read_pace(t);
    const double intensity = t.number("intensity", {0.0, 1.0}).value_or(1.0);
    const auto start = t.number("start_s", {0.0, day_s});
    const auto carrier = t.number("carrier_hz", {1.0, 384000.0});

    const auto described = [&](trajectory motion, std::string note) {
        stroke s{t.text("name").value_or(name), motion, start, carrier, std::move(note)};
        s.speed_mm_s = asked.speed_mm_s;
        return s;
    };
    if (kind == "timed")
        return described(paced(t, asked, read_timed(t, intensity)), {});
    if (kind == "preset") {
        const std::string preset = *t.text("preset");
        stroke s = at_key(t, kind, [&] { return preset_stroke(preset); });
        name = s.name;
        return described(paced(t, asked, s.motion.with_intensity(intensity)), s.note);
    }
    const path way = kind == "points" ? read_points(t)
                     : kind == "arc"
                         ? read_arc(t)
                         : at_key(t, kind, [&, data = *t.text("path")] { return path::from_svg(data); });
    const double seconds = asked.time_for(way.length_mm()).value_or(way.length_mm() / default_speed_mm_s);
    const std::string_view key = asked.speed_mm_s ? "speed_mm_s" : asked.duration_s ? "duration_s" : kind;
    stroke s = described(at_key(t, key, [&] { return trajectory::along(way, seconds, intensity); }), {});
    if (!asked.duration_s && !asked.speed_mm_s)
        s.speed_mm_s = default_speed_mm_s;
    return s;
}

} // namespace

std::vector<stroke> parse_strokes_toml(std::string_view text, const std::string& name)
{
    detail::check_size(text, name, detail::max_tree_bytes,
                       "timed points by the million belong in a CSV file");
    const toml::table document = detail::parse_toml(text, name);
    const toml_table root(document, "a stroke file", name);
    for (const char* key : {"array", "output", "defaults"})
        if (root.has(key))
            root.fail(key, "this is an array or configuration file, not a stroke",
                      "give it as array = FILE or config = FILE");
    root.only({"stroke"});
    if (!root.has("stroke"))
        detail::fail_at({name, 0, 0}, "there is no stroke in it", "add [stroke] or [[stroke]]");

    const std::string stem = detail::stem(name);
    if (root.node("stroke")->is_table())
        return {read_stroke(*root.table("stroke", "[stroke]", "[stroke]"), stem)};
    std::vector<stroke> strokes;
    const std::vector<toml_table> tables = root.tables("stroke");
    if (tables.empty())
        root.fail("stroke", "there is no stroke in it", "add [stroke] or [[stroke]]");
    for (const toml_table& t : tables)
        strokes.push_back(read_stroke(t, fmt::format("{}-{}", stem, strokes.size() + 1)));
    return strokes;
}

} // namespace tactor
