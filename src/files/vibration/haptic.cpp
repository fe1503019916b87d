// SPDX-License-Identifier: MIT
// .haptic files of version 1: amplitude, frequency and emphasis over time.
#include "files/vibration_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/vibration.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

using files::json_value;

constexpr const char* haptic_hint = "export the file again as .haptic 1.0.0";

// Reads a list of values over time. Equal times are a step.
std::vector<timed_value> read_envelope(const json_value& list, const char* value)
{
    std::vector<timed_value> all;
    for (const json_value& p : list.list()) {
        all.push_back(
            {p["time"].need_number({0.0, longest_stroke_s}), p[value].need_number(bounds_of::part)});
        if (all.size() > 1 && all.back().t_s < all[all.size() - 2].t_s)
            p["time"].refuse("it is before that of the previous point", "put times in ascending order");
        if (all.size() > most_vibration_values)
            list.refuse(fmt::format("it has more than {} points", most_vibration_values));
    }
    return all;
}

// Returns the frequency, 0 to 1, for one in hertz.
double normalise_frequency(double low_hz, double high_hz, double hz)
{
    return (hz - low_hz) / (high_hz - low_hz);
}

constexpr double decimals = 1e12; // of values; more would be rounding that bends lines

// Returns the value in 0 to 1 that a file gets.
double rounded(double v)
{
    return std::round(std::clamp(v, 0.0, 1.0) * decimals) / decimals;
}

// A line of values from one time to another.
struct piece {
    double from_s;
    double to_s;
    double from;
    double to;
};

// Adds a line, within 0 to 1.
void add_piece(std::vector<timed_value>& all, const piece& p)
{
    std::vector<timed_value> points{{p.from_s, p.from}, {p.to_s, p.to}};
    for (const double edge : {0.0, 1.0})
        if ((p.from < edge) != (p.to < edge) && p.from != edge && p.to != edge)
            points.push_back({std::lerp(p.from_s, p.to_s, (edge - p.from) / (p.to - p.from)), edge});
    std::sort(points.begin(), points.end(), [](auto& a, auto& b) { return a.t_s < b.t_s; });
    for (const timed_value& t : points)
        all.push_back({t.t_s, rounded(t.value)});
}

// Leaves out points on the line between their neighbours, except at the times of emphases.
void straighten(std::vector<timed_value>& all, const std::vector<emphasis>& at)
{
    std::vector<timed_value> kept;
    auto next = at.begin();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const timed_value& p = all[i];
        next = std::find_if(next, at.end(), [&p](const emphasis& e) { return e.t_s >= p.t_s; });
        if (!kept.empty() && p == kept.back())
            continue;
        const bool emphasised = next != at.end() && next->t_s == p.t_s;
        if (!emphasised && !kept.empty() && i + 1 < all.size() && all[i + 1].t_s > kept.back().t_s) {
            const timed_value& a = kept.back();
            const timed_value& b = all[i + 1];
            const double part = (p.t_s - a.t_s) / (b.t_s - a.t_s);
            const double off_s = 1e-15 * p.t_s; // rounding of a time
            if (std::abs(p.value - std::lerp(a.value, b.value, part)) <=
                2.0 / decimals + off_s * std::abs(b.value - a.value) / (b.t_s - a.t_s))
                continue;
        }
        kept.push_back(p);
    }
    all = std::move(kept);
}

// Returns the vibration of strokes, for the actuator that the format publishes.
vibration make_vibration(joined_strokes from)
{
    vibration v{.duration_s = from.duration_s()};
    const actuator_numbers& a = v.actuator;
    for (const short_touch& t : from.touches())
        v.emphases.push_back({t.t_s, rounded(t.amplitude),
                              rounded(normalise_frequency(a.emphasis_low_hz, a.emphasis_high_hz, t.hz))});
    std::vector<double> times = from.knots();
    for (std::size_t i = 0; i < v.emphases.size(); ++i)
        times.insert(times.end(), {v.emphases[i].t_s, emphasis_end_s(v, i)});
    merge_steps(times);
    for (emphasis& e : v.emphases) // a step may have moved by a microsecond
        e.t_s = *std::lower_bound(times.begin(), times.end() - 1, e.t_s);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        // The sum of several strokes has a mean frequency that is no line.
        const int parts = from.at(std::lerp(times[i], times[i + 1], 0.01)).strokes > 1 ? 16 : 1;
        for (int k = 0; k < parts; ++k) {
            const double from_s = std::lerp(times[i], times[i + 1], static_cast<double>(k) / parts);
            const double to_s = std::lerp(times[i], times[i + 1], (k + 1.0) / parts);
            // A step may be at the start, or in the last microsecond, so two times between them give the
            // line.
            const double quarter_s = 0.25 * (to_s - from_s - step_s);
            const joined_strokes::sound one = from.at(from_s + quarter_s);
            const joined_strokes::sound two = from.at(from_s + 3.0 * quarter_s);
            const auto add = [&](std::vector<timed_value>& all, double at_one, double at_two) {
                const double slope = (at_two - at_one) / (2.0 * quarter_s);
                add_piece(all, {from_s, to_s, at_one - slope * quarter_s,
                                at_one + slope * (to_s - from_s - quarter_s)});
            };
            const double ducked = find_emphasis(v, std::midpoint(from_s, to_s)) ? a.ducking : 1.0;
            add(v.amplitude, one.amplitude / ducked, two.amplitude / ducked);
            if (one.hz > 0.0 && two.hz > 0.0)
                add(v.frequency, normalise_frequency(a.low_hz, a.high_hz, one.hz),
                    normalise_frequency(a.low_hz, a.high_hz, two.hz));
        }
    }
    straighten(v.amplitude, v.emphases);
    straighten(v.frequency, {});
    if (std::all_of(v.frequency.begin(), v.frequency.end(),
                    [](const timed_value& p) { return p.value == usual_frequency; }) &&
        !from.has_carriers_over_time())
        v.frequency.clear();
    if (std::max(v.amplitude.size(), v.frequency.size()) + v.emphases.size() > most_vibration_values)
        throw error(
            error_kind::bad_input, "strokes",
            fmt::format("a HAPTIC file of them would need more than {} points", most_vibration_values),
            "convert fewer or shorter strokes");
    return v;
}

std::string format_haptic(std::span<const stroke> strokes)
{
    const vibration v = make_vibration(joined_strokes(strokes));
    std::string out = R"({"version":{"major":1,"minor":0,"patch":0},"metadata":{"editor":"tactor"},)"
                      "\n"
                      R"("signals":{"continuous":{"envelopes":{"amplitude":[)";
    auto add = [&out, first = true](double t_s, double amplitude, const emphasis* e) mutable {
        fmt::format_to(std::back_inserter(out), R"({}{{"time":{:.15g},"amplitude":{:.12g})",
                       std::exchange(first, false) ? "\n" : ",\n", t_s, amplitude);
        if (e != nullptr)
            fmt::format_to(std::back_inserter(out),
                           R"(,"emphasis":{{"amplitude":{:.12g},"frequency":{:.12g}}})", e->amplitude,
                           e->frequency);
        out += '}';
    };
    auto next = v.emphases.begin();
    for (std::size_t i = 0; i < v.amplitude.size(); ++i) {
        const timed_value& p = v.amplitude[i];
        const bool last_here = i + 1 == v.amplitude.size() || v.amplitude[i + 1].t_s > p.t_s;
        const emphasis* const e =
            last_here && next != v.emphases.end() && next->t_s == p.t_s ? &*next++ : nullptr;
        const bool weaker = e != nullptr && e->amplitude < p.value;
        if (weaker && (i == 0 || v.amplitude[i - 1].t_s < p.t_s))
            add(p.t_s, p.value, nullptr);
        if (weaker) // than its point, which the format does not allow
            add(p.t_s, e->amplitude, e);
        add(p.t_s, p.value, weaker ? nullptr : e);
    }
    out += "],\n\"frequency\":[";
    for (std::size_t i = 0; i < v.frequency.size(); ++i)
        fmt::format_to(std::back_inserter(out), R"({}{{"time":{:.15g},"frequency":{:.12g}}})",
                       i == 0 ? "\n" : ",\n", v.frequency[i].t_s, v.frequency[i].value);
    return out + "]}}}}\n";
}

constexpr std::string_view haptic_extensions[] = {".haptic"};

} // namespace

vibration read_haptic(std::string_view text, const std::string& name)
{
    const auto document = files::read_foreign_object(text, name);
    const json_value root(document, name, haptic_hint);
    const double major = root["version"]["major"].need_number();
    if (major != 1.0)
        root["version"].refuse(fmt::format("version {} is not supported", plain_number(major)));
    const json_value envelopes = root["signals"]["continuous"]["envelopes"];
    const json_value points = envelopes["amplitude"].need_member();
    vibration v{.amplitude = read_envelope(points, "amplitude"),
                .frequency = read_envelope(envelopes["frequency"], "frequency")};
    if (v.amplitude.size() < 2)
        points.refuse(fmt::format("it has {}", counted(v.amplitude.size(), "point")), "give at least two");
    v.duration_s = v.amplitude.back().t_s;
    if (!(v.duration_s > 0.0))
        points.refuse("all its times are 0", "give the last point a later time");
    for (const json_value& p : points.list())
        if (const json_value e = p["emphasis"]; e.exists())
            v.emphases.push_back({p["time"].need_number(), e["amplitude"].need_number(bounds_of::part),
                                  e["frequency"].need_number(bounds_of::part)});
    std::size_t cut = 0;
    for (std::size_t i = 0; i < v.emphases.size(); ++i)
        cut += emphasis_end_s(v, i) - v.emphases[i].t_s > step_s ? 0 : 1;
    if (cut != 0)
        v.notes.push_back(
            fmt::format("{}: {} left out, because the vibration or the next emphasis leaves no time", name,
                        counted(cut, "emphasis is", "emphases are")));
    return v;
}

extern const stroke_format haptic_strokes{
    .name = "haptic",
    .title = "HAPTIC",
    .extensions = haptic_extensions,
    .media_type = "application/json",
    .begins =
        [](std::string_view text) {
            return find_text_form(text) == text_form::json && text.find("\"signals\"") != text.npos;
        },
    .parse =
        [](const stroke_file_text& s) {
            vibration v = read_haptic(s.text, s.name);
            if (s.actuator != nullptr)
                v.actuator = *s.actuator;
            return make_vibration_strokes(v, s.name);
        },
    .write = format_haptic,
    .one_vibration = true,
    .starts_from_strokes = true,
    .comment = {},
    .most_bytes = max_foreign_bytes,
};

} // namespace tactor::detail
