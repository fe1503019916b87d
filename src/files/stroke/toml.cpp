// SPDX-License-Identifier: MIT
// Reader of stroke files in TOML, with [stroke] or [[stroke]].
#include <tactor/stroke.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/pace.hpp"
#include "core/suggest.hpp"
#include "core/trajectory/impl.hpp"
#include "core/trajectory/recorded_points.hpp"
#include "files/setup_text.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"
#include "files/toml_reader.hpp"

namespace tactor::detail {
namespace {

constexpr std::size_t most_strokes = 100'000; // a higher number is a wrong file, or a mistake in `repeat`
constexpr unsigned most_repeats = 10'000;
constexpr unsigned deepest_group = 8;
constexpr double longest_soa_s = 10.0;

constexpr std::string_view kinds[] = {"path", "points", "timed", "arc", "preset"};
constexpr std::string_view order_keys[] = {"name", "start_s", "start_from", "repeat", "pause_s"};
constexpr std::string_view placing_keys[] = {"scale", "rotate_deg", "translate_mm", "mirror", "about_mm"};
constexpr std::string_view fit_keys[] = {"stroke", "level_db", "fit", "fit_margin_mm"};
constexpr std::string_view movement_keys[] = {"duration_s", "speed_mm_s", "intensity",
                                              "easing",     "pauses",     "reverse"};
constexpr std::string_view sound_keys[] = {"carrier_hz", "waveform", "am_hz",      "am_depth",
                                           "noise_seed", "texture",  "texture_mm", "carrier_profile"};
constexpr std::string_view choice_keys[] = {"algorithm", "phantom", "faces", "soa_s", "burst_s"};

template <class... Lists>
std::vector<std::string_view> join_keys(const Lists&... lists)
{
    std::vector<std::string_view> all;
    (all.insert(all.end(), std::begin(lists), std::end(lists)), ...);
    return all;
}

// Returns make(). Errors from make() get the place in the file.
template <class F>
auto with_place(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        t.fail(key, e.subject() == key ? std::string(e.why()) : fmt::format("{}: {}", e.subject(), e.why()),
               e.hint());
    }
}

void refuse_unused(const toml_table& t, const char* key, bool used, const char* hint)
{
    if (t.has(key) && !used)
        t.fail(key, fmt::format("{} has {}, but nothing uses it", t.title(), key), hint);
}

std::optional<waveform> read_waveform(const toml_table& t, const std::filesystem::path* folder)
{
    const auto text = t.text("waveform");
    const auto seed = t.number("noise_seed", bounds_of::seed);
    const auto texture = t.kind<texture_kind>("texture");
    const auto texture_mm = t.number("texture_mm", bounds_of::texture_mm);
    waveform w;
    if (text && folder == nullptr && waveform_names_file(*text))
        t.fail(
            "waveform",
            fmt::format("waveform names the file {}, but strokes read from a text cannot name files", *text),
            "give the stroke as a file");
    if (text)
        w = with_place(t, "waveform", [&] { return parse_waveform(*text, folder ? *folder : ""); });
    const bool recorded = w.kind == waveform_kind::recording;
    refuse_unused(t, "noise_seed", w.kind == waveform_kind::noise, "add waveform = \"noise:LO-HI\"");
    refuse_unused(t, "texture", recorded, "add waveform = \"FILE.wav\"");
    refuse_unused(t, "texture_mm", recorded, "add waveform = \"FILE.wav\" and texture = \"length\"");
    if (!text)
        return {};
    if (seed && *seed != std::floor(*seed))
        t.fail("noise_seed", fmt::format("noise_seed is {}", *seed), "give a whole number");
    w.seed = static_cast<std::uint64_t>(seed.value_or(static_cast<double>(w.seed)));
    w.texture = texture.value_or(w.texture);
    refuse_unused(t, "texture_mm", w.texture == texture_kind::length, "add texture = \"length\"");
    w.texture_mm = texture_mm.value_or(0.0);
    with_place(t, "waveform", [&] { validate(w); });
    return w;
}

std::optional<modulation> read_modulation(const toml_table& t)
{
    const auto hz = t.number("am_hz", bounds_of::am_hz);
    const auto depth = t.number("am_depth", bounds_of::part);
    refuse_unused(t, "am_depth", hz.has_value(), "add am_hz, such as am_hz = 30.0");
    return hz ? std::optional(modulation{*hz, depth.value_or(1.0)}) : std::nullopt;
}

/// Calls take(part, entry) for each entry of a list. Each entry begins with a part of the path. The parts
/// must ascend.
template <class Take>
void for_each_part(const toml_table& t, std::string_view key, std::string_view shape, std::size_t most,
                   Take take)
{
    const toml::array& list = *t.list(key, shape);
    if (list.empty())
        t.fail(key, fmt::format("{} is an empty list", key), fmt::format("give {}", shape));
    double before = -1.0;
    for (const toml::node& node : list) {
        const toml::array* entry = node.as_array();
        if (!entry || entry->size() < 2 || entry->size() > most)
            fail_at(t.where(node), fmt::format("an entry of {} is {}", key, shown(node)),
                    fmt::format("give {}", shape));
        const double part = t.to_number((*entry)[0], "the fraction of the path", bounds_of::part);
        if (!(part > before))
            fail_at(t.where(node),
                    fmt::format("part {} of {} is not after the previous one, {}", part, key, before),
                    "put parts in ascending order, from 0, the path's start, to 1, its end");
        before = part;
        take(part, *entry);
    }
}

/// Reads the points of a profile. A point is a profile_point or a carrier_part.
template <class Point>
std::vector<Point> read_profile(const toml_table& t, std::string_view key, bounds values)
{
    std::vector<Point> points;
    for_each_part(t, key, "[[part, value], ...]", 2, [&](double part, const toml::array& entry) {
        points.push_back({part, t.to_number(entry[1], key, values)});
    });
    return points;
}

std::vector<rest> read_pauses(const toml_table& t)
{
    std::vector<rest> rests;
    for_each_part(t, "pauses", "[[part, seconds], ...] or [[part, seconds, intensity], ...]", 3,
                  [&](double part, const toml::array& entry) {
                      const double time = t.to_number(entry[1], "a pause", {0.0, longest_stroke_s, true});
                      const double intensity =
                          entry.size() == 3
                              ? t.to_number(entry[2], "the intensity of a pause", bounds_of::part)
                              : 1.0;
                      rests.push_back({part, time, intensity});
                  });
    return rests;
}

/// Reads the sound. `folder` is the folder of WAV files. If it is null, the text is not from a file of this
/// machine and must not name files.
void read_sound(const toml_table& t, const std::filesystem::path* folder, stroke& s)
{
    s.sound.wave = read_waveform(t, folder);
    s.sound.am = read_modulation(t);
    if (s.sound.wave)
        s.places.wave = t.where("waveform");
    if (!t.has("carrier_profile"))
        return;
    if (t.has("carrier_hz"))
        t.fail("carrier_profile", fmt::format("{} has both carrier_hz and carrier_profile", t.title()),
               "keep one of them");
    s.sound.carrier_profile = read_profile<carrier_part>(t, "carrier_profile", bounds_of::carrier_hz);
    s.places.carrier = t.where("carrier_profile");
}

/// Reads carrier_hz, which is a number or a list of frequencies over time.
void read_carrier(const toml_table& t, stroke& s)
{
    constexpr std::string_view shape = "[[seconds, Hz], ...]";
    if (!t.has("carrier_hz"))
        return;
    s.places.carrier = t.where("carrier_hz");
    if (!t.node("carrier_hz")->is_array()) {
        s.sound.carrier_hz = t.number("carrier_hz", bounds_of::carrier_hz);
        return;
    }
    double before_s = 0.0;
    for (const toml::node& node : *t.list("carrier_hz", shape)) {
        const toml::array* entry = node.as_array();
        if (!entry || entry->size() != 2)
            fail_at(t.where(node), fmt::format("an entry of carrier_hz is {}", shown(node)),
                    fmt::format("give {}", shape));
        const double t_s = t.to_number((*entry)[0], "a time of carrier_hz", {0.0, longest_stroke_s});
        if (t_s < before_s)
            fail_at(t.where(node),
                    fmt::format("time {} of carrier_hz is before the previous one, {}", t_s, before_s),
                    "put times in ascending order");
        before_s = t_s;
        s.sound.carrier_times.push_back({t_s, t.to_number((*entry)[1], "carrier_hz", bounds_of::carrier_hz)});
    }
    if (s.sound.carrier_times.empty())
        t.fail("carrier_hz", "carrier_hz is an empty list", fmt::format("give {}", shape));
}

/// Reads fit and fit_margin_mm. Returns nothing if the stroke is not to be fitted.
std::optional<stroke_fit> read_fit(const toml_table& t)
{
    const bool fit = t.boolean("fit").value_or(false);
    const auto margin = t.number("fit_margin_mm", bounds_of::margin_mm);
    if (margin && !fit)
        t.fail("fit_margin_mm", "fit_margin_mm is set, but nothing is fitted",
               "add fit = true, or leave out fit_margin_mm");
    return fit ? std::optional(stroke_fit{margin.value_or(0.0)}) : std::nullopt;
}

/// Reads the options that may differ between the strokes of a piece.
void read_choices(const toml_table& t, stroke& s)
{
    s.choices.algorithm = t.kind<algorithm_kind>("algorithm");
    s.choices.phantom = t.kind<phantom_kind>("phantom");
    s.choices.faces = t.kind<faces_kind>("faces");
    s.choices.soa_s = t.number("soa_s", {0.0, longest_soa_s, true});
    s.choices.burst_s = t.number("burst_s", bounds_of::burst_s);
    if (s.choices.soa_s && s.choices.burst_s && *s.choices.burst_s > *s.choices.soa_s)
        t.fail("burst_s",
               fmt::format("burst_s is {}, longer than soa_s, {}", *s.choices.burst_s, *s.choices.soa_s),
               "lower burst_s to soa_s or less: bursts must not overlap");
    for (const char* key : {"burst_s", "soa_s"})
        if (t.has(key))
            s.places.choices = t.where(key);
    s.fit = read_fit(t);
}

/// Applies level_db to a stroke. Then mirrors, scales, rotates and moves it as the other keys say. A stroke
/// with a speed keeps its speed.
void place_stroke(const toml_table& t, stroke& s)
{
    constexpr bounds levels_db{-120.0, 0.0}; // a file can make a stroke weaker but not stronger
    constexpr bounds scales{0.0, 1e6, true};
    s.choices.level_db += t.number("level_db", levels_db).value_or(0.0);
    const auto about = t.place("about_mm");
    const auto first =
        std::find_if(std::begin(placing_keys), std::end(placing_keys), [&t](auto key) { return t.has(key); });
    if (first == std::end(placing_keys))
        return;
    if (*first == "about_mm")
        t.fail("about_mm", "about_mm is set, but nothing is scaled, turned or mirrored",
               "add scale, rotate_deg or mirror, or leave out about_mm");
    affine m = t.turn(t.number("scale", scales).value_or(1.0));
    const point by = t.place("translate_mm").value_or(point{});
    const point from = about.value_or(point{});
    m.e = from.x_mm + by.x_mm;
    m.f = from.y_mm + by.y_mm;
    s.motion = t.add_key_to_errors(*first, [&] {
        const trajectory placed = map_trajectory(s.motion, from, m, {}, *first);
        return s.speed_mm_s && placed.length_mm() > 0.0 ? placed.with_speed(*s.speed_mm_s) : placed;
    });
}

/// The keys that determine a stroke's pace.
struct pace_keys {
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {}; ///< constant speed
    double intensity = 1.0;                ///< constant intensity
    movement moves = {};                   ///< easing, lists and pauses
    std::string_view uneven = {};          ///< first key that makes the pace uneven; empty if none

    /// Returns the time for a length, s, or nothing if the file has no time.
    std::optional<double> time_s(double length_mm) const
    {
        return speed_mm_s ? length_mm / *speed_mm_s : duration_s;
    }
    /// Returns the mean speed that a stroke keeps when it is fitted, or nothing if the file has a time.
    std::optional<double> mean_speed_mm_s(double length_mm) const
    {
        return moves.speed_mm_s.empty() ? speed_mm_s : length_mm / travel_time_s(moves, length_mm);
    }
};

pace_keys read_pace(const toml_table& t)
{
    pace_keys p;
    const auto note_uneven = [&p](std::string_view key) { p.uneven = p.uneven.empty() ? key : p.uneven; };
    // Reads a key whose value is a number or a profile.
    const auto read = [&](std::string_view key, bounds one, double least) -> std::optional<double> {
        if (!t.has(key) || !t.node(key)->is_array())
            return t.number(key, one);
        note_uneven(key);
        (key == "intensity" ? p.moves.intensity : p.moves.speed_mm_s) =
            read_profile<profile_point>(t, key, {least, one.high});
        return {};
    };
    p.duration_s = t.number("duration_s", {0.0, longest_stroke_s, true});
    if (const auto easing = t.kind<easing_kind>("easing")) {
        p.moves.easing = *easing;
        note_uneven("easing");
    }
    p.speed_mm_s = read("speed_mm_s", {0.0, max_mm, true}, least_speed_mm_s);
    p.intensity = read("intensity", bounds_of::part, 0.0).value_or(1.0);
    if (t.has("pauses")) {
        p.moves.rests = read_pauses(t);
        note_uneven("pauses");
    }
    if (p.duration_s && t.has("speed_mm_s"))
        t.fail("speed_mm_s", fmt::format("{} has both duration_s and speed_mm_s", t.title()),
               "keep one of them");
    return p;
}

/// Returns a movement along a path, at the pace in the file. If the file has no pace, the duration is
/// `usual_s`.
trajectory make_motion(const toml_table& t, std::string_view kind, const path& way, const pace_keys& keys,
                       double usual_s)
{
    movement m = keys.moves;
    m.duration_s = keys.time_s(way.length_mm());
    if (!m.duration_s && m.speed_mm_s.empty())
        m.duration_s = usual_s;
    // A speed and the usual time of a preset apply to the movement without pauses, so add the pauses.
    if (m.duration_s && !keys.duration_s)
        for (const rest& r : m.rests)
            *m.duration_s += r.time_s;
    const std::string_view key = !m.rests.empty()      ? "pauses"
                                 : t.has("speed_mm_s") ? "speed_mm_s"
                                 : keys.duration_s     ? "duration_s"
                                                       : kind;
    return t.add_key_to_errors(key, [&] { return trajectory::along(way, m, keys.intensity); });
}

path read_points(const toml_table& t)
{
    std::vector<point> points;
    const toml::array& list = *t.list("points", "[x, y]");
    points.reserve(list.size());
    for (const toml::node& entry : list)
        points.push_back(t.to_point(entry, "a point"));
    return t.add_key_to_errors("points", [&] { return path::polyline(points); });
}

path read_arc(const toml_table& t)
{
    const toml_table a = *t.table("arc", "arc", "arc = { centre, radius_mm, from_deg, sweep_deg }");
    a.refuse_other_keys({"centre", "radius_mm", "from_deg", "sweep_deg"});
    const point centre = a.need(a.place("centre"), "centre");
    const double radius = a.need(a.number("radius_mm", {0.0, max_mm, true}), "radius_mm");
    const double from = a.need(a.number("from_deg", turn_deg), "from_deg");
    const double sweep = a.need(a.number("sweep_deg", {-360.0, 360.0}), "sweep_deg");
    return t.add_key_to_errors("arc", [&] { return path::arc(centre, radius, from, sweep); });
}

// Reads a recording. It keeps its own times unless the file has a duration. Adds remarks to `warnings`.
trajectory read_timed_trajectory(const toml_table& t, const pace_keys& keys, double intensity_max,
                                 std::vector<std::string>& warnings)
{
    const toml::node* row = t.node("timed");
    recorded_points points_read(intensity_max, [&](recorded value) {
        const toml::array* a = row->as_array();
        const auto i = static_cast<std::size_t>(value);
        return t.where(a != nullptr && i < a->size() ? (*a)[i] : *row);
    });
    const toml::array& list = *t.list("timed", "[t_s, x_mm, y_mm]");
    points_read.reserve(list.size());
    for (const toml::node& entry : list) {
        const toml::array* a = entry.as_array();
        if (!a || a->size() < 3 || a->size() > 4 ||
            !std::all_of(a->begin(), a->end(), [](const toml::node& n) { return n.is_number(); }))
            fail_at(t.where(entry), fmt::format("a timed point is {}", shown(entry)),
                    "give [t_s, x_mm, y_mm] or [t_s, x_mm, y_mm, intensity]");
        row = &entry;
        const auto value = [a](std::size_t i) { return *(*a)[i].value<double>(); };
        points_read.add({value(0), {value(1), value(2)}, a->size() == 4 ? value(3) : intensity_max});
    }
    row = t.node("timed");
    std::vector<timed_point> points = points_read.take();
    warnings = points_read.warnings();
    for (timed_point& p : points)
        p.intensity *= keys.intensity;
    const trajectory own = t.add_key_to_errors("timed", [&] { return trajectory::timed(std::move(points)); });
    const auto seconds = keys.time_s(own.length_mm());
    return seconds ? t.add_key_to_errors(keys.speed_mm_s ? "speed_mm_s" : "duration_s",
                                         [&] { return own.with_duration(*seconds); })
                   : own;
}

// Reads the name, movement and carrier of a stroke.
stroke read_drawing(const toml_table& t, std::string name, double intensity_max)
{
    const std::string_view kind = t.one_of(join_keys(kinds));
    if (t.has("stroke"))
        t.one_of({kind, "stroke"}); // throws if the table has both
    const pace_keys keys = read_pace(t);
    stroke s{.name = t.text("name").value_or(std::move(name)), .speed_mm_s = keys.speed_mm_s};
    read_carrier(t, s);
    if (kind == "timed") {
        if (!keys.uneven.empty())
            t.fail(keys.uneven,
                   fmt::format("{} is only for a path: timed points have their own times and intensities",
                               keys.uneven),
                   fmt::format("leave out {}, or give the path as points", keys.uneven));
        s.motion = read_timed_trajectory(t, keys, intensity_max, s.warnings);
        return s;
    }
    std::optional<stroke> preset;
    if (kind == "preset") {
        preset = t.add_key_to_errors(kind, [&, id = *t.text("preset")] { return preset_stroke(id); });
        if (!t.has("name"))
            s.name = preset->name;
        s.note = preset->note;
        s.made_for = preset->made_for;
    }
    const path way =
        preset             ? std::get<drawn_path>(access::of(preset->motion).law).way
        : kind == "points" ? read_points(t)
        : kind == "arc"
            ? read_arc(t)
            : t.add_key_to_errors(kind, [&, data = *t.text("path")] { return path::from_svg(data); });
    s.motion = make_motion(t, kind, way, keys,
                           preset ? preset->motion.duration_s() : way.length_mm() / default_speed_mm_s);
    s.speed_mm_s = keys.mean_speed_mm_s(way.length_mm());
    s.usual_pace = !preset && !keys.duration_s && !s.speed_mm_s;
    if (s.usual_pace)
        s.speed_mm_s = default_speed_mm_s;
    return s;
}

/// Strokes of one entry of the file. The starts of all but the first are relative to other strokes of the
/// entry.
struct file_entry {
    std::vector<stroke> strokes = {};
    double lead_s = 0.0; ///< time from the entry's start to its first stroke
};

void start(stroke& s, double start_s, start_from_kind from, std::size_t back)
{
    s.start_s = start_s;
    s.anchor = {from, static_cast<unsigned>(back)}; // at most most_strokes
}

/// Makes a stroke start `wait_s` after the last `back` strokes. If it follows the last stroke without a wait,
/// it has no start time: such a start is exact to the frame.
void start_after(stroke& s, double wait_s, std::size_t back)
{
    if (wait_s == 0.0 && back == 1) {
        s.start_s.reset();
        s.anchor = {};
    } else {
        start(s, wait_s, start_from_kind::end, back);
    }
}

void check_count(const toml_table& t, std::string_view key, std::size_t strokes)
{
    if (strokes > most_strokes)
        t.fail(key, fmt::format("there are {} strokes in all", strokes),
               fmt::format("use at most {}", most_strokes));
}

/// Strokes in the order that start_s and start_from of their tables determine.
class sequence {
public:
    /// Constructs an empty sequence. If `in_group` is true, starts are relative to the start of a group
    /// rather than the file.
    explicit sequence(bool in_group) noexcept : in_group_(in_group) {}

    /// Adds the strokes of an entry, which table `t` describes.
    void add(const toml_table& t, file_entry e)
    {
        check_count(t, "stroke", all_.strokes.size() + e.strokes.size());
        place(t, e.strokes.front(), e.lead_s);
        last_size_ = e.strokes.size();
        last_lead_s_ = e.lead_s;
        std::move(e.strokes.begin(), e.strokes.end(), std::back_inserter(all_.strokes));
    }

    file_entry take() && { return std::move(all_); }

private:
    void place(const toml_table& t, stroke& first, double lead_s)
    {
        start_from_kind from = t.kind<start_from_kind>("start_from").value_or(start_from_kind::piece);
        const bool begins = all_.strokes.empty();
        if (begins) // no stroke comes before this one
            from = start_from_kind::piece;
        const double least_s = from == start_from_kind::piece ? 0.0 : -longest_stroke_s;
        const auto start_s = t.number("start_s", {least_s, longest_stroke_s});
        const double after_s = start_s.value_or(0.0) + lead_s;
        if (start_s && *start_s < 0.0)
            first.places.start = t.where("start_s");
        if (begins && in_group_)
            all_.lead_s = after_s;
        else if (begins && !start_s && lead_s == 0.0)
            return;
        else if (from == start_from_kind::end || (!begins && !start_s && !t.has("start_from")))
            start_after(first, after_s, last_size_);
        else if (from == start_from_kind::start)
            start(first, after_s - last_lead_s_, from, last_size_);
        else if (in_group_)
            start(first, after_s - all_.lead_s, start_from_kind::start, all_.strokes.size());
        else
            start(first, after_s, from, 1);
    }

    bool in_group_;
    file_entry all_;
    std::size_t last_size_ = 0;
    double last_lead_s_ = 0.0;
};

/// Returns an entry repeated as often as `repeat` says, with `pause_s` between repetitions.
file_entry repeat_entry(const toml_table& t, file_entry e)
{
    const unsigned times = t.whole("repeat", 1, most_repeats).value_or(1);
    const auto pause = t.number("pause_s", {0.0, longest_stroke_s});
    if (pause && times == 1)
        t.fail("pause_s", "pause_s is set, but nothing is repeated",
               "add repeat = 2 or more; for pauses along a path use pauses = [[part, seconds], ...]");
    if (times == 1)
        return e;
    const std::size_t once = e.strokes.size();
    check_count(t, "repeat", once * times);
    e.strokes.reserve(once * times);
    for (std::size_t i = once; i < once * times; ++i) {
        e.strokes.push_back(e.strokes[i - once]);
        if (i % once == 0)
            start_after(e.strokes[i], pause.value_or(0.0) + e.lead_s, once);
    }
    for (std::size_t i = 0; i < e.strokes.size(); ++i)
        e.strokes[i].name += fmt::format(" ({} of {})", i / once + 1, times);
    return e;
}

file_entry read_stroke_entry(const toml_table& t, std::string name, const stroke_file_text& r)
{
    t.refuse_other_keys(
        join_keys(kinds, movement_keys, placing_keys, order_keys, fit_keys, choice_keys, sound_keys));
    stroke s = read_drawing(t, std::move(name), r.intensity_max);
    read_choices(t, s);
    read_sound(t, r.folder, s);
    if (t.boolean("reverse").value_or(false)) {
        s.motion = t.add_key_to_errors("reverse", [&] { return s.motion.reversed(); });
        s.sound = reverse_sound(std::move(s.sound), s.motion.duration_s());
    }
    place_stroke(t, s);
    return repeat_entry(t, {.strokes = {std::move(s)}});
}

file_entry read_entry(const toml_table& t, const std::string& name, const stroke_file_text& r, unsigned depth,
                      unsigned& fitted);

file_entry read_all(const std::vector<toml_table>& tables, bool in_group, const std::string& name,
                    const stroke_file_text& r, unsigned depth, unsigned& fitted)
{
    sequence all(in_group);
    std::size_t number = 0;
    for (const toml_table& t : tables)
        all.add(t, read_entry(t, fmt::format("{}-{}", name, ++number), r, depth, fitted));
    return std::move(all).take();
}

// Reads a group: strokes that are placed, weakened and repeated as a whole. `fitted`: number of the last
// group that is fitted.
file_entry read_group(const toml_table& t, const std::string& name, const stroke_file_text& r, unsigned depth,
                      unsigned& fitted)
{
    t.refuse_other_keys(join_keys(placing_keys, order_keys, fit_keys));
    if (depth == deepest_group)
        t.fail("stroke", "groups are nested too deep", fmt::format("use at most {} levels", deepest_group));
    const std::vector<toml_table> inside = t.tables("stroke");
    if (inside.empty())
        t.fail("stroke", "a group has no stroke", "add [[stroke.stroke]]");
    file_entry e = read_all(inside, true, t.text("name").value_or(name), r, depth + 1, fitted);
    auto fit = read_fit(t);
    if (fit)
        fit->group = ++fitted;
    for (stroke& s : e.strokes) {
        place_stroke(t, s);
        if (fit && s.fit)
            t.fail("fit", fmt::format("{} is in a group that is fitted", detail::quoted(s.name)),
                   "fit either the group or the strokes in it");
        if (fit)
            s.fit = fit;
    }
    return repeat_entry(t, std::move(e));
}

file_entry read_entry(const toml_table& t, const std::string& name, const stroke_file_text& r, unsigned depth,
                      unsigned& fitted)
{
    const bool group = t.has("stroke") && std::none_of(std::begin(kinds), std::end(kinds),
                                                       [&t](auto kind) { return t.has(kind); });
    return group ? read_group(t, name, r, depth, fitted) : read_stroke_entry(t, name, r);
}

std::vector<stroke> read_strokes(const stroke_file_text& r)
{
    const toml::table document = parse_toml(r.text, r.name);
    const toml_table root(document, "a stroke file", r.name);
    for (const char* key : {"array", "output", "defaults"})
        if (root.has(key))
            root.fail(key, "this is an array or configuration file, not a stroke",
                      "give it as {array=FILE} or {config=FILE}");
    root.refuse_other_keys({"stroke"});
    if (!root.has("stroke"))
        fail_at({r.name, 0, 0}, "it has no stroke", "add [stroke] or [[stroke]]");

    // Strokes of several files may be fitted in one call: each file has its own range of numbers.
    unsigned fitted = static_cast<unsigned>(std::hash<std::string>{}(r.name)) & ~0xffffU;
    if (root.node("stroke")->is_table()) {
        sequence one(false);
        const toml_table t = *root.table("stroke", "[stroke]", "[stroke]");
        one.add(t, read_entry(t, stem(r.name), r, 0, fitted));
        return std::move(one).take().strokes;
    }
    const std::vector<toml_table> tables = root.tables("stroke");
    if (tables.empty())
        root.fail("stroke", "it has no stroke", "add [stroke] or [[stroke]]");
    return read_all(tables, false, stem(r.name), r, 0, fitted).strokes;
}

constexpr std::string_view toml_extensions[] = {".toml"};

} // namespace

extern const stroke_format toml_strokes{
    .name = "toml",
    .title = "TOML",
    .extensions = toml_extensions,
    .media_type = "application/toml",
    .begins = [](std::string_view text) { return find_text_form(text) == text_form::toml; },
    .parse = read_strokes,
    .write = strokes_text,
    .starts_from_strokes = true,
    .shorten = "put millions of timed points into a CSV file",
};

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<stroke> parse_strokes_toml(std::string_view text, const std::string& name, double intensity_max)
{
    return detail::read_stroke_text(detail::toml_strokes, {text, name, intensity_max});
}

} // namespace v0
} // namespace tactor
