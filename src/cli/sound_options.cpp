// SPDX-License-Identifier: MIT
// What vibrates, and how a burst rises and falls.
#include <charconv>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/parse_number.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {
namespace {

namespace of = detail::option_bounds;

// The library's words about a field, as the option's.
template <class F>
auto said_of(const char* option, F make)
{
    try {
        return make();
    } catch (const error& e) {
        const bool field = e.subject() == "waveform" || e.subject() == "am" || e.subject() == "texture" ||
                           e.subject() == "envelope" || e.subject() == "intensity scale";
        throw e.reworded(field ? std::string(option) : fmt::format("{}: {}", option, e.subject()), e.why(),
                         e.hint());
    }
}

// Seed and texture have options of their own, which may come before.
void take_waveform(waveform& into, const std::string& text)
{
    const waveform w = said_of("--waveform", [&] { return parse_waveform(text); });
    into.kind = w.kind;
    into.low_hz = w.low_hz;
    into.high_hz = w.high_hz;
    into.recorded = w.recorded;
}

std::uint64_t parse_seed(const std::string& text)
{
    std::uint64_t v = 0;
    const char* end = text.data() + text.size();
    const auto r = std::from_chars(text.data(), end, v);
    // Plans keep it as JSON's numbers.
    if (r.ec != std::errc() || r.ptr != end || v > std::uint64_t{1} << 53U)
        throw error(error_kind::bad_input, "--noise-seed", fmt::format("\"{}\" is not a seed", text),
                    "give a whole number from 0 to 2^53");
    return v;
}

// The ramps have options of their own, which may come before.
void take_envelope(burst_envelope& into, const std::string& text)
{
    const burst_envelope e = said_of("--envelope", [&] { return parse_envelope(text); });
    into.kind = e.kind;
    into.tukey_part = e.tukey_part;
}

} // namespace

void option_list::add_waveform_options()
{
    settings& s = settings_;
    value("--waveform", "sine|square|triangle|sawtooth|noise:LO-HI|FILE.wav",
          "what vibrates (default sine): a shape at the carrier's frequency, noise between two, or samples",
          [&s](const std::string& t) { take_waveform(s.plan.wave, t); });
    value("--am", "HZ[:DEPTH]", "amplitude modulation, depth 0 to 1 (default: none; depth 1)",
          [&s](const std::string& t) { s.plan.am = said_of("--am", [&] { return parse_modulation(t); }); });
    value("--noise-seed", "N", "noise: which (default 1)",
          [&s](const std::string& t) { s.plan.wave.seed = parse_seed(t); });
    value("--texture", "cycle|time|length",
          "FILE.wav: the carrier's cycle (default), in its own time, or laid along the path",
          [&s](const std::string& t) {
              s.plan.wave.texture = said_of("--texture", [&] { return from_string<texture_kind>(t); });
          });
    value("--texture-mm", "MM",
          "--texture length: so much of the path has the whole file (default: all of it)",
          [&s](const std::string& t) {
              s.plan.wave.texture_mm = parse_number("--texture-mm", t, of::texture_mm, "mm");
          });
}

void option_list::add_envelope_options()
{
    settings& s = settings_;
    value("--envelope", "raised-cosine|linear|exponential|tukey[:PART]",
          "how a burst rises and falls (default raised-cosine; tukey: by a part of it, default 0.5)",
          [&s](const std::string& t) { take_envelope(s.render.envelope, t); });
    value("--attack", "S", "time in which each burst rises (default: what --ramp says)",
          [&s](const std::string& t) {
              s.render.envelope.attack_s = parse_number("--attack", t, of::attack, "s");
          });
    value("--release", "S", "time in which it falls (default: that in which it rises)",
          [&s](const std::string& t) {
              s.render.envelope.release_s = parse_number("--release", t, of::release, "s");
          });
}

void option_list::add_scale_options()
{
    settings& s = settings_;
    value("--intensity-scale", "linear|sl|stevens",
          "what an intensity of one half is: of the amplitude (default), of --sl in dB, of what is felt",
          [&s](const std::string& t) {
              s.plan.scale.kind = said_of("--intensity-scale", [&] { return from_string<scale_kind>(t); });
          });
    value("--stevens-exponent", "E",
          "felt = amplitude^E (default 0.6, at 250 Hz; 0.95 at 60 Hz: Stevens 1968)",
          [&s](const std::string& t) {
              s.plan.scale.exponent = parse_number("--stevens-exponent", t, of::stevens_exponent, "");
          });
}

void option_list::settle_scale()
{
    settings& s = settings_;
    if (given("stevens-exponent") && s.plan.scale.kind != scale_kind::stevens)
        throw error(error_kind::bad_input, "--stevens-exponent", "nothing here uses it",
                    "add --intensity-scale stevens");
    if (s.plan.scale.kind != scale_kind::sl || !has("sl"))
        return;
    if (!(s.render.sl_db.value_or(0.0) > 0.0))
        throw error(error_kind::bad_input, "--intensity-scale",
                    "sl is a part of a sensation level above 0 dB", "add --sl DB, such as --sl 7");
    s.plan.scale.sl_db = *s.render.sl_db;
}

void option_list::check_sound() const
{
    const settings& s = settings_;
    const auto unused = [&](const char* option, bool used, const char* hint) {
        if (given(option) && !used)
            throw error(error_kind::bad_input, fmt::format("--{}", option), "nothing here uses it", hint);
    };
    const waveform& w = s.plan.wave;
    const bool recorded = w.kind == waveform_kind::recording;
    unused("noise-seed", w.kind == waveform_kind::noise, "add --waveform noise:LO-HI");
    unused("texture", recorded, "add --waveform FILE.wav");
    unused("texture-mm", recorded && w.texture == texture_kind::length,
           "add --waveform FILE.wav --texture length");
    const bool own = s.render.envelope.kind == envelope_kind::tukey;
    for (const char* ramp : {"attack", "release", "ramp"})
        if (own && given(ramp))
            throw error(error_kind::bad_input, fmt::format("--{}", ramp),
                        "--envelope tukey has its own ramps", "leave one of them out");
}

} // namespace tactor::cli
