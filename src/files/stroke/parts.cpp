// SPDX-License-Identifier: MIT
#include "files/stroke/parts.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/moved.hpp"

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

} // namespace tactor::detail
