// SPDX-License-Identifier: MIT
#include "core/vibration.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"

namespace tactor::detail {

double value_at(const std::vector<timed_value>& all, double t_s, double without)
{
    if (all.empty())
        return without;
    const auto above = std::upper_bound(all.begin(), all.end(), t_s,
                                        [](double t, const timed_value& p) { return t < p.t_s; });
    if (above == all.begin())
        return above->value;
    const timed_value& below = *(above - 1);
    if (above == all.end())
        return below.value;
    return std::lerp(below.value, above->value, (t_s - below.t_s) / (above->t_s - below.t_s));
}

double carrier_hz(const actuator_numbers& a, double frequency)
{
    return std::lerp(a.low_hz, a.high_hz, frequency);
}

double emphasis_hz(const actuator_numbers& a, double frequency)
{
    return std::lerp(a.emphasis_low_hz, a.emphasis_high_hz, frequency);
}

double emphasis_s(const vibration& v, std::size_t i)
{
    return std::lerp(v.actuator.emphasis_low_s, v.actuator.emphasis_high_s, v.emphases[i].frequency);
}

double emphasis_end_s(const vibration& v, std::size_t i)
{
    const double own_s = std::min(v.emphases[i].t_s + emphasis_s(v, i), v.duration_s);
    return v.own_actuator || i + 1 == v.emphases.size() ? own_s : std::min(own_s, v.emphases[i + 1].t_s);
}

std::optional<std::size_t> last_emphasis(const vibration& v, double t_s)
{
    const auto above = std::upper_bound(v.emphases.begin(), v.emphases.end(), t_s,
                                        [](double t, const emphasis& e) { return t < e.t_s; });
    if (above == v.emphases.begin())
        return {};
    return static_cast<std::size_t>(above - v.emphases.begin()) - 1;
}

std::optional<std::size_t> find_emphasis(const vibration& v, double t_s)
{
    const auto i = last_emphasis(v, t_s);
    return i && t_s < emphasis_end_s(v, *i) ? i : std::nullopt;
}

void check_vibration(const vibration& v, const std::string& name)
{
    const auto need = [&name](bool holds, const char* why) {
        if (!holds)
            throw error(error_kind::bad_input, name, why,
                        "give times that ascend from 0, and values from 0 to 1")
                .with_field("recorded");
    };
    const auto check_time = [&need, before = 0.0](double t_s) mutable {
        need(t_s >= before && t_s <= longest_stroke_s, "a time of its vibration is out of order or range");
        before = t_s;
    };
    need(v.duration_s > 0.0 && v.duration_s <= longest_stroke_s && !v.amplitude.empty(),
         "its vibration has no duration or no amplitude");
    for (const auto* all : {&v.amplitude, &v.frequency}) {
        auto ascend = check_time;
        for (const timed_value& p : *all) {
            ascend(p.t_s);
            need(bounds_of::part.holds(p.value), "a value of its vibration is out of range");
        }
    }
    auto check = check_time;
    for (const emphasis& e : v.emphases) {
        check(e.t_s);
        need(bounds_of::part.holds(e.amplitude) && bounds_of::part.holds(e.frequency),
             "an emphasis is out of range");
    }
    const actuator_numbers& a = v.actuator;
    for (const double hz : {a.low_hz, a.high_hz, a.emphasis_low_hz, a.emphasis_high_hz})
        need(bounds_of::carrier_hz.holds(hz), "a frequency of its actuator is out of range");
    for (const double s : {a.emphasis_low_s, a.emphasis_high_s})
        need(s > 0.0 && s <= 1.0, "an emphasis of its actuator is out of range");
    for (const double part : {a.gain, a.ducking, a.emphasis_gain, a.fade_out})
        need(bounds_of::part.holds(part), "a part of its actuator is out of range");
}

} // namespace tactor::detail
