// SPDX-License-Identifier: MIT
#include <tactor/waveform.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/kind_names.hpp"
#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/vibration.hpp"
#include "core/words.hpp"

namespace tactor {
inline namespace v0 {
namespace {

void check_noise(const waveform& w)
{
    // NaN fails this test, too.
    if (!(w.low_hz >= least_noise_hz && w.high_hz >= w.low_hz + least_noise_hz &&
          w.high_hz <= detail::bounds_of::carrier_hz.high))
        throw error(error_kind::bad_input, "waveform",
                    fmt::format("noise from {} to {} Hz cannot be made", w.low_hz, w.high_hz),
                    "give two frequencies of 1 Hz or more, the second at least 1 Hz above the first, such as "
                    "noise:50-500")
            .with_field("waveform");
}

void check_samples(const recording& r)
{
    const auto refuse = [&r](std::string_view why, std::string_view hint) {
        throw error(error_kind::bad_input, recording_name(r), why, hint).with_field("recorded");
    };
    if (r.samples.size() < 2 || r.samples.size() > most_recording_samples)
        refuse(fmt::format("it has {}", counted(r.samples.size(), "sample")),
               fmt::format("give 2 to {}", most_recording_samples));
    if (!(r.rate_hz >= 1.0 && r.rate_hz <= 1e6))
        refuse(fmt::format("its rate is {} Hz", r.rate_hz), "give 1 to 1000000 Hz");
    if (!std::all_of(r.samples.begin(), r.samples.end(), [](float x) { return std::isfinite(x); }))
        refuse("it has a sample that is not a number", "");
    if (std::adjacent_find(r.samples.begin(), r.samples.end(), std::not_equal_to<>()) == r.samples.end())
        refuse("it is silent: all its samples are equal", "give a recording of a vibration");
}

void check_recording(const waveform& w)
{
    if (!w.recorded)
        throw error(error_kind::bad_input, "waveform", "the recording has no samples",
                    "give the samples as recorded")
            .with_field("waveform");
    if (w.recorded->source)
        detail::check_vibration(*w.recorded->source, recording_name(*w.recorded));
    else
        check_samples(*w.recorded);
    if (w.texture != texture_kind::time && w.recorded->samples.size() > most_cycle_samples)
        throw error(
            error_kind::bad_input, recording_name(*w.recorded),
            fmt::format("{} are too many for texture {}", counted(w.recorded->samples.size(), "sample"),
                        to_string(w.texture)),
            fmt::format("give at most {}, which is 8 s at 8 kHz, or use texture time", most_cycle_samples))
            .with_field("recorded");
    if (!detail::bounds_of::texture_mm.holds(w.texture_mm))
        throw detail::bad_field("texture_mm", fmt::format("{} mm is not a length", w.texture_mm),
                                "give 0 to 1000000; 0 is the whole path");
}

// Reads a number that is followed by the end of the text or by the character `end`.
std::optional<double> read_number_until(std::string_view text, std::size_t& at, char end)
{
    const auto v = detail::scan_number(text, at);
    return v && (at == text.size() || text[at] == end) ? v : std::nullopt;
}

} // namespace

TACTOR_KIND_NAMES(waveform_kind, "waveform", {sine, "sine"}, {square, "square"}, {triangle, "triangle"},
                  {sawtooth, "sawtooth"}, {noise, "noise"}, {recording, "recording"});
TACTOR_KIND_NAMES(texture_kind, "texture", {cycle, "cycle"}, {time, "time"}, {length, "length"});

bool operator==(const waveform& a, const waveform& b)
{
    if (a.kind != b.kind)
        return false;
    if (a.kind == waveform_kind::noise)
        return a.low_hz == b.low_hz && a.high_hz == b.high_hz && a.seed == b.seed;
    if (a.kind != waveform_kind::recording)
        return true;
    const bool same = a.recorded == b.recorded || (a.recorded && b.recorded && *a.recorded == *b.recorded);
    return same && a.texture == b.texture && a.texture_mm == b.texture_mm;
}

std::string waveform_text(const waveform& w)
{
    if (w.kind == waveform_kind::noise)
        return fmt::format("noise:{}-{}", w.low_hz, w.high_hz);
    if (w.kind == waveform_kind::recording)
        return w.recorded ? w.recorded->file : "";
    return std::string(to_string(w.kind));
}

modulation parse_modulation(std::string_view text)
{
    modulation m;
    std::size_t at = 0;
    const auto hz = read_number_until(text, at, ':');
    std::optional<double> depth = m.depth;
    if (hz && at < text.size())
        depth = read_number_until(text, ++at, '\0');
    if (!hz || !depth)
        throw detail::bad_field("am", fmt::format("\"{}\" is not HZ or HZ:DEPTH", text),
                                "give a value such as 30 or 30:0.5");
    m.hz = *hz;
    m.depth = *depth;
    validate(m);
    return m;
}

void validate(const waveform& w)
{
    if (w.kind == waveform_kind::noise)
        check_noise(w);
    if (w.kind == waveform_kind::recording)
        check_recording(w);
}

void validate(const modulation& m)
{
    if (!detail::bounds_of::am_hz.holds(m.hz))
        throw detail::bad_field("am", fmt::format("{} Hz is not a modulation frequency", m.hz),
                                "give 0 to 20000 Hz; 0 means none");
    if (!detail::bounds_of::part.holds(m.depth))
        throw detail::bad_field("am", fmt::format("{} is not a depth", m.depth),
                                "give 0 to 1; 1 falls to silence");
}

TACTOR_KIND_NAMES(envelope_kind, "envelope", {raised_cosine, "raised-cosine"}, {linear, "linear"},
                  {exponential, "exponential"}, {tukey, "tukey"});

burst_envelope parse_envelope(std::string_view text)
{
    const std::size_t colon = text.find(':');
    burst_envelope e;
    e.kind = from_string<envelope_kind>(text.substr(0, colon));
    if (colon == std::string_view::npos)
        return e;
    std::size_t at = colon + 1;
    const auto part = detail::scan_number(text, at);
    if (e.kind != envelope_kind::tukey || !part || at != text.size() || !detail::bounds_of::part.holds(*part))
        throw detail::bad_field(
            "envelope",
            e.kind == envelope_kind::tukey
                ? fmt::format("\"{}\" has no number from 0 to 1 after the colon", text)
                : fmt::format("{} takes no number after a colon", to_string(e.kind)),
            fmt::format("write {}, or tukey with a number, such as tukey:0.5", to_string(e.kind)));
    e.tukey_part = *part;
    return e;
}

std::string envelope_text(const burst_envelope& e)
{
    if (e.kind == envelope_kind::tukey)
        return fmt::format("tukey:{}", e.tukey_part);
    return std::string(to_string(e.kind));
}

} // namespace v0
} // namespace tactor
