// SPDX-License-Identifier: MIT
#include "server/tool_line.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include <fmt/format.h>

#include "core/words.hpp"

namespace tactor::server {
namespace {

using options::option;

bool is_recording(const options::wishes& s)
{
    return s.plan.wave.kind == waveform_kind::recording;
}

// Returns true for what put_options() says. The texts of strokes may name no recording.
bool is_in_file(const option& o, const options::wishes& s)
{
    constexpr std::uint64_t kept = options::in_stroke | options::live; // others are in the strokes' times
    const bool is_recorded = o.name == "waveform" || o.name.starts_with("texture");
    return ((o.where & kept) == kept && !(is_recorded && is_recording(s))) || o.name == "am";
}

// Returns the options as a command has them: the strokes have their times, and the array has a name.
options::wishes for_command(options::wishes s, const array& a, const tool_files& files)
{
    constexpr unsigned usual_rate = 48000;
    const auto value_if = [](bool is_set, auto v) { return is_set ? std::optional(v) : std::nullopt; };
    s.array_name = value_if(!files.array.empty(), files.array);
    s.config_file = value_if(!files.config.empty(), files.config);
    s.duration_s.reset();
    s.speed_mm_s.reset();
    s.intensity_max.reset();
    s.rate = value_if(s.render.rate != usual_rate, s.render.rate);
    s.channels = value_if(s.render.channels > a.channels(), s.render.channels);
    return s;
}

std::string value_text(const options::value& v)
{
    if (const auto* number = std::get_if<double>(&v))
        return fmt::format(" {}", *number);
    if (const auto* text = std::get_if<std::string>(&v))
        return " " + quote_word(*text);
    return {}; // a flag
}

// Returns true for a value that the command must say. It always has the level, which a configuration on the
// way may set otherwise.
bool is_needed(const option& o, const options::wishes& s, const options::value& v)
{
    static const options::wishes usual;
    const bool is_off = std::holds_alternative<std::monostate>(v) || v == options::value(false);
    const bool is_used = o.used == nullptr || o.used(s);
    if (o.name == "level_dbfs")
        return !s.render.sl_db;
    const bool was_given = s.gives(o) && (o.where & options::by_client) != 0;
    return !is_off && is_used && (was_given || v != o.to.get(usual));
}

constexpr std::size_t longest = 100;

// Beyond ASCII each character counts as a letter.
bool is_allowed(char c) noexcept
{
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 -_";
    return static_cast<unsigned char>(c) >= 0x80 || plain.find(c) != plain.npos;
}

} // namespace

void put_options(stroke& k, const options::wishes& s)
{
    const plan_options& p = s.plan;
    const plan_options usual;
    const auto put = [&s](auto& own, std::string_view option, const auto& asked, const auto& built_in) {
        if (!own && (s.gives(option) || asked != built_in))
            own = asked;
    };
    put(k.choices.algorithm, "algorithm", p.algorithm, usual.algorithm);
    put(k.choices.phantom, "phantom", p.phantom, usual.phantom);
    put(k.choices.faces, "faces", p.faces, usual.faces);
    put(k.choices.soa_s, "soa", p.soa_s, usual.soa_s);
    put(k.choices.burst_s, "burst", p.burst_s, usual.burst_s);
    if (k.sound.carrier_profile.empty())
        put(k.sound.carrier_hz, "carrier", p.carrier_hz, usual.carrier_hz);
    if (!is_recording(s))
        put(k.sound.wave, "waveform", p.wave, usual.wave);
    put(k.sound.am, "am", p.am, usual.am);
}

std::string option_words(const options::wishes& s, options::place command, const array& a,
                         const tool_files& files, bool file_says)
{
    const options::wishes w = for_command(s, a, files);
    std::string words;
    for (const option& o : options::all()) {
        const options::value v = o.to.get(w);
        if ((o.where & command) != 0 && !(file_says && is_in_file(o, w)) && is_needed(o, w, v))
            words += fmt::format(" --{}{}", options::dashed(o), value_text(v));
    }
    return words;
}

std::string quote_word(std::string_view word)
{
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./:,+=@%";
    if (!word.empty() && word.find_first_not_of(plain) == word.npos)
        return std::string(word);
    std::string quoted = "'";
    for (const char c : word)
        quoted += c == '\'' ? "'\\''" : std::string(1, c);
    return quoted + "'";
}

bool is_file_name(std::string_view name)
{
    return make_file_name(name) == name;
}

std::string make_file_name(std::string_view name)
{
    std::string made(first_characters(name, longest));
    std::replace_if(
        made.begin(), made.end(), [](char c) { return !is_allowed(c); }, '_');
    if (has_controls(made)) // escapes and turned lines in a terminal
        std::replace_if(
            made.begin(), made.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '_');
    if (made.starts_with('-') || made.starts_with(' '))
        made.front() = '_';
    while (made.ends_with(' '))
        made.pop_back();
    return made.empty() ? "stroke" : made;
}

} // namespace tactor::server
