// SPDX-License-Identifier: MIT
// Stroke files in TOML: [stroke] or [[stroke]].
#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/limits.hpp"
#include "core/profile.hpp"
#include "core/suggest.hpp"
#include "core/trajectory/impl.hpp"
#include "core/trajectory/recorded_points.hpp"
#include "files/stroke/parts.hpp"
#include "files/text_file.hpp"
#include "files/toml_reader.hpp"

namespace tactor {
inline namespace v0 {
namespace {

/// Circumstances of a text.
struct reading {
    const std::filesystem::path* folder; ///< of its WAV files; null for text that is no file's
    double intensity_max;                ///< value of a timed point that means 1
};

using detail::max_mm;
using detail::told_pace;
using detail::toml_table;

constexpr unsigned deepest_group = 8;

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
    return t.at_key("points", [&] { return path::polyline(points); });
}

path read_arc(const toml_table& t)
{
    const toml_table a = *t.table("arc", "arc", "arc = { centre, radius_mm, from_deg, sweep_deg }");
    a.only({"centre", "radius_mm", "from_deg", "sweep_deg"});
    const point centre = a.need(a.place("centre"), "centre");
    const double radius = a.need(a.number("radius_mm", {0.0, max_mm, true}), "radius_mm");
    const double from = a.need(a.number("from_deg", detail::turn_deg), "from_deg");
    const double sweep = a.need(a.number("sweep_deg", {-360.0, 360.0}), "sweep_deg");
    return t.at_key("arc", [&] { return path::arc(centre, radius, from, sweep); });
}

double number_in(const toml::node& n)
{
    const auto* whole = n.as_integer();
    return whole != nullptr ? static_cast<double>(whole->get()) : n.as_floating_point()->get();
}

// Reads a recording, whose intensities are multiplied by `intensity`. Adds remarks to `warnings`.
trajectory read_timed(const toml_table& t, double intensity, double intensity_max,
                      std::vector<std::string>& warnings)
{
    const toml::node* row = t.node("timed");
    detail::recorded_points recorded(intensity_max, [&](detail::recorded value) {
        const toml::array* a = row->as_array();
        const auto i = static_cast<std::size_t>(value);
        return t.where(a != nullptr && i < a->size() ? (*a)[i] : *row);
    });
    const toml::array& list = *t.list("timed", "[t_s, x_mm, y_mm]");
    recorded.reserve(list.size());
    for (const toml::node& entry : list) {
        const toml::array* a = entry.as_array();
        if (!a || a->size() < 3 || a->size() > 4 ||
            !std::all_of(a->begin(), a->end(), [](const toml::node& n) { return n.is_number(); }))
            detail::fail_at(t.where(entry), fmt::format("a timed point is {}", detail::shown(entry)),
                            "give [t_s, x_mm, y_mm] or [t_s, x_mm, y_mm, intensity]");
        row = &entry;
        const auto value = [a](std::size_t i) { return number_in((*a)[i]); };
        recorded.add({value(0), {value(1), value(2)}, a->size() == 4 ? value(3) : intensity_max});
    }
    row = t.node("timed");
    std::vector<timed_point> points = recorded.take();
    warnings = recorded.warnings();
    for (timed_point& p : points)
        p.intensity *= intensity;
    return t.at_key("timed", [&] { return trajectory::timed(std::move(points)); });
}

// Returns a movement that has its own time in the time that the file gives.
trajectory paced(const toml_table& t, const told_pace& p, trajectory own)
{
    const auto seconds = p.time_for(own.length_mm());
    if (!seconds)
        return own;
    const char* key = p.speed_mm_s ? "speed_mm_s" : "duration_s";
    return t.at_key(key, [&] { return own.with_duration(*seconds); });
}

// Refuses other movements for timed points.
void refuse_uneven(const toml_table& t, const told_pace& p)
{
    if (!p.key.empty())
        t.fail(
            p.key,
            fmt::format("timed points have times and intensities of their own, and {} is for a path", p.key),
            "leave it out, or give the path as points");
}

// Returns a preset's movement, or the one along its path that the file gives.
trajectory preset_as_told(const toml_table& t, const told_pace& p, const trajectory& own)
{
    if (p.key.empty())
        return paced(t, p, own.with_intensity(p.intensity));
    const path& way = std::get<detail::drawn_path>(detail::access::of(own).law).way;
    return detail::along_as_told(t, "preset", way, p, own.duration_s());
}

template <class... Lists>
std::vector<std::string_view> join_keys(const Lists&... lists)
{
    std::vector<std::string_view> all;
    (all.insert(all.end(), std::begin(lists), std::end(lists)), ...);
    return all;
}

constexpr std::array<std::string_view, 5> kinds{"path", "points", "timed", "arc", "preset"};
constexpr std::array<std::string_view, 4> drawing_keys{"duration_s", "speed_mm_s", "intensity", "carrier_hz"};
constexpr std::array<std::string_view, 7> placed_keys{"name",         "start_s", "scale",   "rotate_deg",
                                                      "translate_mm", "mirror",  "about_mm"};

// Reads a stroke before it is placed.
stroke read_drawn(const toml_table& t, std::string name, double intensity_max)
{
    if (t.has("stroke"))
        t.one_of(join_keys(kinds, std::array<std::string_view, 1>{"stroke"})); // refuses two
    const std::string_view kind = t.one_of(kinds);
    const told_pace asked = detail::read_pace(t);
    const auto carrier = t.number("carrier_hz", detail::bounds_of::carrier_hz);

    const auto described = [&](trajectory motion, note_kind note = note_kind::none) {
        stroke s{.name = t.text("name").value_or(name),
                 .motion = motion,
                 .speed_mm_s = asked.speed_mm_s,
                 .sound = {.carrier_hz = carrier},
                 .note = note};
        if (carrier)
            s.places.carrier = t.where("carrier_hz");
        return s;
    };
    if (kind == "timed") {
        refuse_uneven(t, asked);
        std::vector<std::string> warnings;
        stroke s = described(paced(t, asked, read_timed(t, asked.intensity, intensity_max, warnings)));
        s.warnings = std::move(warnings);
        return s;
    }
    if (kind == "preset") {
        const std::string preset = *t.text("preset");
        stroke s = t.at_key(kind, [&] { return preset_stroke(preset); });
        name = s.name;
        std::string made_for = s.made_for;
        s = described(preset_as_told(t, asked, s.motion), s.note);
        s.made_for = std::move(made_for);
        if (!asked.moves.speed_mm_s.empty())
            s.speed_mm_s = detail::kept_speed(asked, s.motion.length_mm());
        return s;
    }
    const path way = kind == "points" ? read_points(t)
                     : kind == "arc"
                         ? read_arc(t)
                         : t.at_key(kind, [&, data = *t.text("path")] { return path::from_svg(data); });
    stroke s = described(detail::along_as_told(t, kind, way, asked, {}));
    s.speed_mm_s = detail::kept_speed(asked, way.length_mm());
    s.usual_pace = !asked.duration_s && !s.speed_mm_s;
    if (s.usual_pace)
        s.speed_mm_s = default_speed_mm_s;
    return s;
}

detail::entry read_one(const toml_table& t, std::string name, const reading& r)
{
    t.only(join_keys(kinds, drawing_keys, placed_keys, detail::movement_keys, detail::order_keys,
                     detail::choice_keys, detail::sound_keys,
                     std::array<std::string_view, 2>{"stroke", "reverse"}));
    stroke s = detail::levelled(t, detail::chosen(t, read_drawn(t, std::move(name), r.intensity_max)));
    detail::read_sound(t, r.folder, s);
    if (t.boolean("reverse").value_or(false)) {
        s.motion = t.at_key("reverse", [&] { return s.motion.reversed(); });
        s.sound.carrier_profile = detail::from_the_end(s.sound.carrier_profile);
    }
    detail::entry e;
    e.strokes.push_back(detail::placed(t, std::move(s)));
    return detail::repeated(t, std::move(e));
}

detail::entry read_entry(const toml_table& t, const std::string& name, const reading& r, unsigned depth);

detail::entry read_all(const std::vector<toml_table>& tables, detail::sequence::of what,
                       const std::string& name, const reading& r, unsigned depth)
{
    detail::sequence all(what);
    std::size_t number = 0;
    for (const toml_table& t : tables)
        all.add(t, read_entry(t, fmt::format("{}-{}", name, ++number), r, depth));
    return std::move(all).take();
}

// Reads strokes that are placed, made weaker and repeated together.
detail::entry read_group(const toml_table& t, const std::string& name, const reading& r, unsigned depth)
{
    t.only(join_keys(placed_keys, detail::order_keys,
                     std::array<std::string_view, 4>{"stroke", "level_db", "fit", "fit_margin_mm"}));
    if (depth == deepest_group)
        t.fail("stroke", "groups in groups too deep", fmt::format("at most {}", deepest_group));
    const std::vector<toml_table> inside = t.tables("stroke");
    if (inside.empty())
        t.fail("stroke", "a group without a stroke", "add [[stroke.stroke]]");
    detail::entry e =
        read_all(inside, detail::sequence::of::group, t.text("name").value_or(name), r, depth + 1);
    auto fit = detail::read_fit(t);
    if (fit)
        fit->group = t.where().line; // no other group of the file begins there
    for (stroke& s : e.strokes) {
        s = detail::placed(t, detail::levelled(t, std::move(s)));
        if (!fit)
            continue;
        if (s.fit)
            t.fail("fit", fmt::format("{} is fitted already", detail::quoted(s.name)),
                   "fit the group, or what is in it");
        s.fit = fit;
    }
    return detail::repeated(t, std::move(e));
}

detail::entry read_entry(const toml_table& t, const std::string& name, const reading& r, unsigned depth)
{
    const bool group = t.has("stroke") && std::none_of(kinds.begin(), kinds.end(),
                                                       [&t](std::string_view k) { return t.has(k); });
    return group ? read_group(t, name, r, depth) : read_one(t, name, r);
}

std::vector<stroke> read_strokes(std::string_view text, const std::string& name, const reading& r)
{
    detail::check_size(text, name, detail::max_tree_bytes,
                       "timed points by the million belong in a CSV file");
    const toml::table document = detail::parse_toml(text, name);
    const toml_table root(document, "a stroke file", name);
    for (const char* key : {"array", "output", "defaults"})
        if (root.has(key))
            root.fail(key, "this is an array or configuration file, not a stroke",
                      "give it as {array=FILE} or {config=FILE}");
    root.only({"stroke"});
    if (!root.has("stroke"))
        detail::fail_at({name, 0, 0}, "there is no stroke in it", "add [stroke] or [[stroke]]");

    const std::string stem = detail::stem(name);
    if (root.node("stroke")->is_table()) {
        detail::sequence one(detail::sequence::of::piece);
        const toml_table t = *root.table("stroke", "[stroke]", "[stroke]");
        one.add(t, read_entry(t, stem, r, 0));
        return std::move(one).take().strokes;
    }
    const std::vector<toml_table> tables = root.tables("stroke");
    if (tables.empty())
        root.fail("stroke", "there is no stroke in it", "add [stroke] or [[stroke]]");
    return read_all(tables, detail::sequence::of::piece, stem, r, 0).strokes;
}

} // namespace

std::vector<stroke> parse_strokes_toml(std::string_view text, const std::string& name, double intensity_max)
{
    return read_strokes(text, name, {nullptr, intensity_max});
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

std::vector<stroke> strokes_of_toml_file(std::string_view text, const std::string& name, double intensity_max)
{
    const std::filesystem::path folder = std::filesystem::path(name).parent_path();
    return read_strokes(text, name, {&folder, intensity_max});
}

} // namespace tactor::detail
