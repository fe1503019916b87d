// SPDX-License-Identifier: MIT
#include "files/stroke/parts.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/limits.hpp"
#include "core/moved.hpp"
#include "core/pace.hpp"

namespace tactor::detail {
namespace {

// Returns make(). What the library refuses, it refuses with the place in the file.
template <class F>
auto said_at(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        const bool about_key = e.subject() == key || e.subject() == "am";
        t.fail(key, about_key ? std::string(e.why()) : fmt::format("{}: {}", e.subject(), e.why()), e.hint());
    }
}

void need_with(const toml_table& t, const char* key, bool used, const char* hint)
{
    if (t.has(key) && !used)
        t.fail(key, fmt::format("{} has {}, which nothing uses", t.title(), key), hint);
}

std::optional<waveform> read_waveform(const toml_table& t, const std::filesystem::path* folder)
{
    const auto text = t.text("waveform");
    const auto seed = t.number("noise_seed", bounds_of::seed);
    const auto texture = t.kind<texture_kind>("texture");
    const auto texture_mm = t.number("texture_mm", bounds_of::texture_mm);
    waveform w;
    if (text && folder == nullptr && waveform_names_file(*text))
        t.fail("waveform", fmt::format("waveform is a file, {}, and this text is none", *text),
               "give the stroke as a file of its own");
    if (text)
        w = said_at(t, "waveform", [&] { return parse_waveform(*text, folder ? *folder : ""); });
    const bool recorded = w.kind == waveform_kind::recording;
    need_with(t, "noise_seed", w.kind == waveform_kind::noise, "add waveform = \"noise:LO-HI\"");
    need_with(t, "texture", recorded, "add waveform = \"FILE.wav\"");
    need_with(t, "texture_mm", recorded, "add waveform = \"FILE.wav\" and texture = \"length\"");
    if (!text)
        return {};
    if (seed && *seed != static_cast<double>(static_cast<std::uint64_t>(*seed)))
        t.fail("noise_seed", fmt::format("noise_seed is {}", *seed), "give a whole number");
    w.seed = static_cast<std::uint64_t>(seed.value_or(static_cast<double>(w.seed)));
    w.texture = texture.value_or(w.texture);
    need_with(t, "texture_mm", w.texture == texture_kind::length, "add texture = \"length\"");
    w.texture_mm = texture_mm.value_or(0.0);
    said_at(t, "waveform", [&] { validate(w); });
    return w;
}

std::optional<modulation> read_modulation(const toml_table& t)
{
    const auto hz = t.number("am_hz", {0.0, 20000.0});
    const auto depth = t.number("am_depth", {0.0, 1.0});
    need_with(t, "am_depth", hz.has_value(), "add am_hz, such as am_hz = 30.0");
    if (!hz)
        return {};
    return modulation{*hz, depth.value_or(1.0)};
}

std::vector<carrier_part> read_profile(const toml_table& t)
{
    std::vector<carrier_part> profile;
    if (!t.has("carrier_profile"))
        return profile;
    if (t.has("carrier_hz"))
        t.fail("carrier_profile", fmt::format("{} has both carrier_hz and carrier_profile", t.title()),
               "keep one of them");
    std::vector<double> pair;
    for (const toml::node& entry : *t.list("carrier_profile", "[part, hz]")) {
        t.numbers(entry, "a point of the carrier", 2, 2, pair);
        const carrier_part p{t.within(entry, "the part of the path", pair[0], {0.0, 1.0}),
                             t.within(entry, "the frequency", pair[1], bounds_of::carrier_hz)};
        if (!profile.empty() && p.part <= profile.back().part)
            fail_at(t.where(entry),
                    fmt::format("the part {} does not come after {}", p.part, profile.back().part),
                    "put them in order, each part once");
        profile.push_back(p);
    }
    if (profile.empty())
        t.fail("carrier_profile", "there are no points in it", "give [[0, 100], [1, 300]]");
    return profile;
}

constexpr double longest_soa_s = 10.0;
constexpr double shortest_burst_s = 0.0001;
constexpr bounds levels_db{-120.0, 60.0};

constexpr double largest_scale = 1e6;
constexpr std::array<std::string_view, 4> placing_keys{"scale", "rotate_deg", "translate_mm", "mirror"};

struct turned {
    double cosine = 1.0;
    double sine = 0.0;
};

// Returns a turn; quarter turns are exact.
turned make_turn(double degrees)
{
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) {
        constexpr std::array<turned, 4> exact{{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}};
        const double rest = std::fmod(quarters, 4.0);
        return exact[static_cast<std::size_t>(rest < 0.0 ? rest + 4.0 : rest)];
    }
    const double angle = degrees * std::numbers::pi / 180.0;
    return {std::cos(angle), std::sin(angle)};
}

constexpr bounds a_part{0.0, 1.0};
constexpr std::size_t most_profile_points = 1'000'000;

/// The numbers of an entry of a list whose first is a part of the path, which ascends.
class part_list {
public:
    part_list(const toml_table& t, std::string_view key, std::string_view shape)
        : table_(t), key_(key), list_(*t.list(key, shape)), shape_(shape)
    {
        if (list_.empty())
            t.fail(key, fmt::format("{} is an empty list", key), fmt::format("give {}", shape));
        if (list_.size() > most_profile_points)
            t.fail(key, fmt::format("{} has {} entries", key, list_.size()),
                   fmt::format("at most {}", most_profile_points));
    }

    /// Calls take(part, entry) for each.
    template <class Take>
    void each(std::size_t least, std::size_t most, Take take)
    {
        double before = -1.0;
        for (const toml::node& node : list_) {
            const toml::array* entry = node.as_array();
            if (!entry || entry->size() < least || entry->size() > most)
                fail_at(table_.where(node), fmt::format("an entry of {} is {}", key_, shown(node)),
                        fmt::format("give {}", shape_));
            const double part = table_.to_number((*entry)[0], "the part of the path", a_part);
            if (!(part > before))
                fail_at(table_.where(node),
                        fmt::format("the part {} of {} does not come after {}", part, key_, before),
                        "parts ascend from 0, the path's start, to 1, its end");
            before = part;
            take(part, *entry);
        }
    }

private:
    const toml_table& table_;
    std::string_view key_;
    const toml::array& list_;
    std::string_view shape_;
};

std::vector<profile_point> read_profile(const toml_table& t, std::string_view key, bounds values)
{
    std::vector<profile_point> points;
    part_list(t, key, "[[part, value], ...]").each(2, 2, [&](double part, const toml::array& entry) {
        points.push_back({part, t.to_number(entry[1], key, values)});
    });
    return points;
}

std::vector<rest> read_pauses(const toml_table& t)
{
    std::vector<rest> rests;
    part_list(t, "pauses", "[[part, seconds], ...] or [[part, seconds, intensity], ...]")
        .each(2, 3, [&](double part, const toml::array& entry) {
            const double time = t.to_number(entry[1], "a pause", {0.0, longest_stroke_s, true});
            const double intensity =
                entry.size() == 3 ? t.to_number(entry[2], "the intensity of a pause", {0.0, 1.0}) : 1.0;
            rests.push_back({part, time, intensity});
        });
    return rests;
}

bool is_list(const toml_table& t, std::string_view key)
{
    return t.has(key) && t.node(key)->is_array();
}

constexpr unsigned most_repeats = 10'000;

void start(stroke& s, double start_s, start_from_kind from, std::size_t back)
{
    s.start_s = start_s;
    s.anchor = {from, static_cast<unsigned>(back)}; // at most most_strokes
}

/// Places a stroke after the last `back` strokes. Right after the last one it gets no number: that is exact
/// to the frame.
void follow(stroke& s, double wait_s, std::size_t back)
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
        t.fail(key, fmt::format("{} strokes in all", strokes), fmt::format("at most {}", most_strokes));
}

start_from_kind read_from(const toml_table& t)
{
    return t.kind<start_from_kind>("start_from").value_or(start_from_kind::piece);
}

} // namespace

void read_sound(const toml_table& t, const std::filesystem::path* folder, stroke& s)
{
    s.sound.wave = read_waveform(t, folder);
    s.sound.am = read_modulation(t);
    s.sound.carrier_profile = read_profile(t);
    if (s.sound.wave)
        s.places.wave = t.where("waveform");
    if (!s.sound.carrier_profile.empty())
        s.places.carrier = t.where("carrier_profile");
}

stroke chosen(const toml_table& t, stroke s)
{
    s.choices.algorithm = t.kind<algorithm_kind>("algorithm");
    s.choices.phantom = t.kind<phantom_kind>("phantom");
    s.choices.faces = t.kind<faces_kind>("faces");
    s.choices.soa_s = t.number("soa_s", {0.0, longest_soa_s, true});
    s.choices.burst_s = t.number("burst_s", {shortest_burst_s, longest_soa_s});
    if (s.choices.soa_s && s.choices.burst_s && *s.choices.burst_s > *s.choices.soa_s)
        t.fail("burst_s",
               fmt::format("burst_s is {}, longer than soa_s of {}", *s.choices.burst_s, *s.choices.soa_s),
               "bursts must not overlap: at most soa_s");
    for (const char* key : {"burst_s", "soa_s"})
        if (t.has(key))
            s.places.choices = t.where(key);
    s.fit = read_fit(t);
    return s;
}

std::optional<stroke_fit> read_fit(const toml_table& t)
{
    const bool fit = t.boolean("fit").value_or(false);
    const auto margin = t.number("fit_margin_mm", {0.0, max_mm});
    if (margin && !fit)
        t.fail("fit_margin_mm", "nothing is fitted", "add fit = true, or leave it out");
    return fit ? std::optional(stroke_fit{margin.value_or(0.0)}) : std::nullopt;
}

stroke levelled(const toml_table& t, stroke s)
{
    s.choices.level_db += t.number("level_db", levels_db).value_or(0.0);
    return s;
}

affine read_turn(const toml_table& t, double scale)
{
    const turned turn = make_turn(t.number("rotate_deg", turn_deg).value_or(0.0));
    const std::string mirror = t.choice("mirror", {"x", "y"}).value_or("");
    const double x = mirror == "x" ? -scale : scale;
    const double y = mirror == "y" ? -scale : scale;
    return {x * turn.cosine, x * turn.sine, -y * turn.sine, y * turn.cosine, 0.0, 0.0};
}

stroke placed(const toml_table& t, stroke s)
{
    std::string_view first;
    for (const std::string_view key : placing_keys)
        if (first.empty() && t.has(key))
            first = key;
    const auto about = t.place("about_mm");
    if (first.empty()) {
        if (about)
            t.fail("about_mm", "nothing is scaled, turned or mirrored about it",
                   "add scale, rotate_deg or mirror, or leave it out");
        return s;
    }
    const double scale = t.number("scale", {0.0, largest_scale, true}).value_or(1.0);
    affine m = read_turn(t, scale);
    const point by = t.place("translate_mm").value_or(point{});
    const point from = about.value_or(point{});
    m.e = from.x_mm + by.x_mm;
    m.f = from.y_mm + by.y_mm;
    s.motion = t.at_key(first, [&] {
        const trajectory there = moved(s.motion, from, m, {}, [&] { return std::string(first); });
        return s.speed_mm_s && there.length_mm() > 0.0 ? there.with_speed(*s.speed_mm_s) : there;
    });
    return s;
}

told_pace read_pace(const toml_table& t)
{
    told_pace p;
    const auto uneven = [&](std::string_view key) { p.key = p.key.empty() ? key : p.key; };
    p.duration_s = t.number("duration_s", {0.0, longest_stroke_s, true});
    if (const auto easing = t.kind<easing_kind>("easing")) {
        p.moves.easing = *easing;
        uneven("easing");
    }
    if (is_list(t, "speed_mm_s")) {
        p.moves.speed_mm_s = read_profile(t, "speed_mm_s", {least_speed_mm_s, max_mm});
        uneven("speed_mm_s");
    } else {
        p.speed_mm_s = t.number("speed_mm_s", {0.0, max_mm, true});
    }
    if (is_list(t, "intensity")) {
        p.moves.intensity = read_profile(t, "intensity", {0.0, 1.0});
        uneven("intensity");
    } else {
        p.intensity = t.number("intensity", {0.0, 1.0}).value_or(1.0);
    }
    if (t.has("pauses")) {
        p.moves.rests = read_pauses(t);
        uneven("pauses");
    }
    if (p.duration_s && t.has("speed_mm_s"))
        t.fail("speed_mm_s", fmt::format("{} has both duration_s and speed_mm_s", t.title()),
               "keep one of them");
    return p;
}

trajectory along_as_told(const toml_table& t, std::string_view kind, const path& way, const told_pace& told,
                         std::optional<double> own_s)
{
    const bool speeds = !told.moves.speed_mm_s.empty();
    std::optional<double> seconds = told.time_for(way.length_mm());
    std::string_view key = told.speed_mm_s || speeds ? "speed_mm_s" : told.duration_s ? "duration_s" : kind;
    if (!seconds && !speeds)
        seconds = own_s.value_or(way.length_mm() / default_speed_mm_s);
    movement m = told.moves;
    m.duration_s = seconds;
    // A speed, and a preset's own time, are of the movement: pauses come on top.
    if (seconds && !told.duration_s)
        for (const rest& r : m.rests)
            *m.duration_s += r.time_s;
    if (!m.rests.empty())
        key = "pauses";
    return t.at_key(key, [&] {
        return told.key.empty() ? trajectory::along(way, *seconds, told.intensity)
                                : trajectory::along(way, m, told.intensity);
    });
}

std::optional<double> kept_speed(const told_pace& told, double length_mm)
{
    if (!told.moves.speed_mm_s.empty())
        return length_mm / time_at_speeds_s(told.moves, length_mm);
    return told.speed_mm_s;
}

void sequence::place_first(const toml_table& t, stroke& first, double lead_s)
{
    static_cast<void>(read_from(t)); // whatever it is, there is nothing before
    const auto told = t.number("start_s", {0.0, longest_stroke_s});
    const double after_s = told.value_or(0.0) + lead_s;
    if (!whole_piece_)
        all_.lead_s = after_s;
    else if (told || lead_s > 0.0)
        start(first, after_s, start_from_kind::piece, 1);
}

void sequence::place(const toml_table& t, stroke& first, double lead_s) const
{
    const start_from_kind from = read_from(t);
    const auto told =
        t.number("start_s", {from == start_from_kind::piece ? 0.0 : -longest_stroke_s, longest_stroke_s});
    const double after_s = told.value_or(0.0) + lead_s;
    if (told && *told < 0.0)
        first.places.start = t.where("start_s");
    if (from == start_from_kind::end || (!told && !t.has("start_from")))
        follow(first, after_s, before_.size);
    else if (from == start_from_kind::start)
        start(first, after_s - before_.lead_s, from, before_.size);
    else if (whole_piece_)
        start(first, after_s, from, 1);
    else
        start(first, after_s - all_.lead_s, start_from_kind::start, all_.strokes.size());
}

void sequence::add(const toml_table& t, entry e)
{
    check_count(t, "stroke", all_.strokes.size() + e.strokes.size());
    if (all_.strokes.empty())
        place_first(t, e.strokes.front(), e.lead_s);
    else
        place(t, e.strokes.front(), e.lead_s);
    before_ = {e.strokes.size(), e.lead_s};
    all_.strokes.insert(all_.strokes.end(), std::make_move_iterator(e.strokes.begin()),
                        std::make_move_iterator(e.strokes.end()));
}

entry repeated(const toml_table& t, entry e)
{
    const auto times = t.whole("repeat", 1, most_repeats);
    const auto pause = t.number("pause_s", {0.0, longest_stroke_s});
    if (pause && times.value_or(1) == 1)
        t.fail("pause_s", "nothing is repeated",
               "add repeat = 2 or more; pauses = [[part, seconds], ...] is along a path");
    if (times.value_or(1) == 1)
        return e;
    const std::size_t once = e.strokes.size();
    check_count(t, "repeat", once * *times);
    const std::vector<stroke> first = e.strokes;
    for (unsigned pass = 1; pass < *times; ++pass) {
        for (const stroke& s : first)
            e.strokes.push_back(s);
        follow(e.strokes[pass * once], pause.value_or(0.0) + e.lead_s, once);
    }
    for (std::size_t i = 0; i < e.strokes.size(); ++i)
        e.strokes[i].name += fmt::format(" ({} of {})", i / once + 1, *times);
    return e;
}

} // namespace tactor::detail
