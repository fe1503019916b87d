// SPDX-License-Identifier: MIT
#include "study/session/limit_check.hpp"

#include <cstddef>
#include <set>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::study {
namespace {

constexpr std::size_t block_frames = 4096;

bool sound_alike(const score& a, const score& b)
{
    const std::size_t bytes = block_frames * a.channels() * bytes_of(format_kind::float32);
    std::vector<std::byte> of_a(bytes);
    std::vector<std::byte> of_b(bytes);
    renderer one(a, format_kind::float32);
    renderer other(b, format_kind::float32);
    for (std::uint64_t at = 0; at < a.frames(); at += block_frames) {
        one.process(of_a);
        other.process(of_b);
        if (of_a != of_b)
            return false;
    }
    return true;
}

drive_limits without_time(drive_limits l)
{
    l.max_drive_s = l.window_s;
    return l;
}

void check(const experiment_definition& d, const planned_trial& t, const stimulus_set& stimuli,
           const drive_limits& l)
{
    const score planned = stimuli.make_score(t);
    if (sound_alike(planned, stimuli.make_score(t, l)))
        return;
    const bool of_time = sound_alike(planned, stimuli.make_score(t, without_time(l)));
    const motion_definition& m = d.motions[t.motion];
    std::string by = fmt::format("method \"{}\"", d.methods[t.method_1].name);
    if (t.method_2)
        by += fmt::format(" and then by \"{}\"", d.methods[*t.method_2].name);
    throw error(error_kind::bad_input, m.where,
                fmt::format("motion \"{}\" by {}: {} would change it", m.name, by,
                            of_time ? fmt::format("[limits] max_drive_s, {} s in {} s for one tactor,",
                                                  l.max_drive_s, l.window_s)
                                    : fmt::format("[limits] power_dbfs, {:.4g} dB,", l.power_dbfs)),
                of_time ? "shorter strokes, or other limits where the actuators bear them"
                        : "a lower level, or other limits where the actuators bear them");
}

} // namespace

void check_limits(const experiment_definition& d, const std::vector<run_sequence>& runs,
                  const stimulus_set& stimuli, const drive_limits& l)
{
    std::set<std::tuple<std::size_t, std::size_t, std::size_t>> seen;
    for (const run_sequence& r : runs)
        for (const auto* list : {&r.practice, &r.trials})
            for (const planned_trial& t : *list)
                if (seen.insert({t.motion, t.method_1, t.method_2.value_or(t.method_1)}).second)
                    check(d, t, stimuli, l);
}

} // namespace tactor::study
