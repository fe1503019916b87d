// SPDX-License-Identifier: MIT
// .haptic files of version 1: amplitude, frequency and emphasis over time.
#include "files/vibration_file.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

using files::json_value;

constexpr const char* haptic_hint = "export it again as .haptic 1.0.0";

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
};

} // namespace tactor::detail
