// SPDX-License-Identifier: MIT
#include "synth/score/levels.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"

namespace tactor::synth {

namespace {

// Returns a tactor's level, dBFS. Without a threshold it is full scale, so that check_peaks() finds its
// drives.
double level_db(const array& a, std::size_t i, const render_options& o)
{
    const tactor_spec& t = a.tactors[i];
    if (o.sl_db) {
        const auto threshold = threshold_at(t, reference_hz);
        return threshold ? *threshold + *o.sl_db : 0.0;
    }
    const double level = o.level_dbfs + t.gain_db;
    if (!(level <= 1e-9)) {
        refuse_tactor(
            a, i, o,
            fmt::format(
                "would be driven at {:.4g} dBFS, above full scale: gain_db = {} on a level of {} dBFS", level,
                t.gain_db, o.level_dbfs),
            fmt::format("lower gain_db, or {{level_dbfs}} to {:.4g} or less", -t.gain_db));
    }
    return level;
}

} // namespace

void refuse_tactor(const array& a, std::size_t i, const render_options& o, std::string_view why,
                   std::string_view hint)
{
    const source_place& at = a.tactors[i].where;
    const std::string name = fmt::format("tactor {}", i);
    if (at.text().empty())
        throw error(error_kind::bad_input, name, why, hint).with_field(o.sl_db ? "sl_db" : "level_dbfs");
    throw error(error_kind::bad_input, at, fmt::format("{} {}", name, why), hint);
}

void refuse_unmeasured(const array& a, std::size_t i, const render_options& o)
{
    refuse_tactor(a, i, o,
                  fmt::format("has no threshold_dbfs, but a sensation level of {} dB is asked for",
                              o.sl_db.value_or(0.0)),
                  "run {command:calibrate}, or use {level_dbfs}");
}

std::vector<std::size_t> unmeasured_tactors(const array& a, const render_options& o)
{
    std::vector<std::size_t> all;
    for (std::size_t i = 0; o.sl_db && i < a.tactors.size(); ++i)
        if (!threshold_at(a.tactors[i], reference_hz))
            all.push_back(i);
    return all;
}

double tactor_limit(const array& a, std::size_t i)
{
    return std::pow(10.0, std::min(0.0, a.tactors[i].max_dbfs) / 20.0) * (1.0 + 1e-9);
}

std::vector<tactor_level> tactor_levels(const array& a, const render_options& o)
{
    if (o.sl_db && !std::isfinite(*o.sl_db)) {
        throw detail::bad_field("sl_db", fmt::format("{} is not a level", *o.sl_db),
                                "the paper uses 7 dB SL");
    }
    if (!o.sl_db && !(std::isfinite(o.level_dbfs) && o.level_dbfs <= 0.0)) {
        throw detail::bad_field("level_dbfs",
                                fmt::format("{} dBFS is not a level of 0 dBFS or less", o.level_dbfs),
                                "the default is -12");
    }
    std::vector<tactor_level> levels;
    levels.reserve(a.tactors.size());
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        const double gain = std::pow(10.0, level_db(a, i, o) / 20.0);
        levels.push_back({t.channel, t.polarity < 0 ? -gain : gain});
    }
    return levels;
}

} // namespace tactor::synth
