// SPDX-License-Identifier: MIT
#include "files/stroke/sound.hpp"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace tactor::detail {
namespace {

// What the library refuses, with the place in the file.
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
    const auto seed = t.number("noise_seed", {0.0, 9007199254740992.0});
    const auto texture = t.kind<texture_kind>("texture");
    const auto texture_mm = t.number("texture_mm", {0.0, max_mm, true});
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
                             t.within(entry, "the frequency", pair[1], {1.0, 384000.0})};
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

} // namespace

void read_sound(const toml_table& t, const std::filesystem::path* folder, stroke& s)
{
    s.wave = read_waveform(t, folder);
    s.am = read_modulation(t);
    s.carrier_profile = read_profile(t);
    if (s.wave)
        s.wave_at = t.where("waveform");
    if (!s.carrier_profile.empty())
        s.carrier_at = t.where("carrier_profile");
}

} // namespace tactor::detail
